/** Most bytes of UTF-8: file systems take 255, and some programs add to a name. */
const MOST_BYTES = 200;
/** What Windows, Unix or zip programs refuse or follow, what terminals obey, and what hides in text. */
const REFUSED = /[\p{Cc}\p{Cs}\p{Zl}\p{Zp}\p{Bidi_C}\u200b\u2060\ufeff<>:"/\\|?*]/gu;
/** Devices of Windows, with any end; it passes over spaces before that. */
const RESERVED =
  /^(?:con|prn|aux|nul|com[\d\u00b9\u00b2\u00b3]|lpt[\d\u00b9\u00b2\u00b3]|conin\$|conout\$)(?= *(?:\.|$))/i;

/**
 * A name from outside, of a file, a folder or a scene, as one part of a path or the name of a saved
 * file on any system. Names that are so already stay as they are.
 *
 * @param name as it came: any text, of any length.
 * @returns at least one character, at most 200 bytes; the end of a file's name is kept.
 */
export function pathSegment(name: string): string {
  const plain = name
    .replace(REFUSED, '_')
    // Windows drops dots and spaces at the end. Each run of them is tried once: names may be long.
    .replace(/(?<![. ])[. ]+$/, '_')
    // A leading dot hides a file, or configures a server.
    .replace(/^(?:\.+| +)/, '_');
  return shortened(plain.replace(RESERVED, '_$&') || '_');
}

function shortened(name: string): string {
  const bytesOf = (text: string) => new TextEncoder().encode(text).length;
  if (bytesOf(name) <= MOST_BYTES) return name;
  const [end = ''] = /(?:\.[a-z\d]{1,12}){1,2}$/i.exec(name) ?? [];
  let length = 0;
  let bytes = bytesOf(end);
  for (const character of name) {
    bytes += bytesOf(character);
    if (bytes > MOST_BYTES) break;
    length += character.length;
  }
  return name.slice(0, length) + end;
}
