/** Most UTF-8 bytes of a name: file systems allow 255, and some programs append to a name. */
const MOST_BYTES = 200;
/**
 * Characters that Windows, Unix or zip programs refuse or interpret, terminal control characters,
 * and invisible ones.
 */
const REFUSED = /[\p{Cc}\p{Cs}\p{Zl}\p{Zp}\p{Bidi_C}\u200b\u2060\ufeff<>:"/\\|?*]/gu;
/** Windows device names, with any extension; Windows ignores spaces before the extension. */
const RESERVED =
  /^(?:con|prn|aux|nul|com[\d\u00b9\u00b2\u00b3]|lpt[\d\u00b9\u00b2\u00b3]|conin\$|conout\$)(?= *(?:\.|$))/i;

/**
 * Turns an untrusted name of a file, folder or scene into one path segment, or a file name, that is
 * valid on any system. Valid names are unchanged.
 *
 * @param name any text, of any length.
 * @returns at least one character and at most 200 bytes; the file extension is kept.
 */
export function pathSegment(name: string): string {
  const plain = name
    .replace(REFUSED, '_')
    // Windows drops trailing dots and spaces. The lookbehind tries each run once: names may be
    // long.
    .replace(/(?<![. ])[. ]+$/, '_')
    // A leading dot hides a file or makes it a server's configuration.
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
