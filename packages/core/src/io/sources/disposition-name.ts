/** A parameter of a header: its name, and its value in quotes or without. */
const PARAMETER = /;\s*([\w!#$%&'*+.^`|~-]+)\s*=\s*(?:"((?:[^"\\]|\\.)*)"|([^;]*))/gs;
/** A value with its character set (RFC 8187). */
const EXTENDED = /^(utf-8|iso-8859-1)'[^']*'(.*)$/is;

/**
 * The name that a Content-Disposition gives a file (RFC 6266): its `filename*`, else its
 * `filename`; undefined if it gives none. Only its end is to be trusted, as of any name from a server.
 */
export function dispositionName(header: string): string | undefined {
  let plain: string | undefined;
  for (const [, name, quoted, token = ''] of header.matchAll(PARAMETER)) {
    const value = quoted?.replace(/\\(.)/gs, '$1') ?? token.trim();
    if (name.toLowerCase() === 'filename') plain ??= value;
    if (name.toLowerCase() !== 'filename*') continue;
    const extended = decodedValue(value);
    if (extended !== undefined) return extended;
  }
  return plain;
}

/** Undefined for what cannot be decoded. */
function decodedValue(value: string): string | undefined {
  const [, charset, text] = EXTENDED.exec(value) ?? [];
  if (charset === undefined) return undefined;
  const octet = (_: string, digits: string) => String.fromCharCode(Number.parseInt(digits, 16));
  if (charset.toLowerCase() !== 'utf-8') return text.replace(/%([\da-f]{2})/gi, octet);
  try {
    return decodeURIComponent(text);
  } catch {
    return undefined;
  }
}
