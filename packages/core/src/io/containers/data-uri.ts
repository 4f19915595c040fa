/** Value of each character of base64 by its code; 255 for all others. */
const VALUES = new Uint8Array(128).fill(255);
for (const [value, character] of [
  ...'ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/',
].entries()) {
  VALUES[character.charCodeAt(0)] = value;
}

export function isDataUri(uri: string): boolean {
  return /^data:/i.test(uri);
}

/**
 * Decodes a data: URI with base64 (RFC 2397). Pages may not be allowed to fetch one.
 *
 * @returns null if it is anything else.
 */
export function decodeDataUri(uri: string): Uint8Array<ArrayBuffer> | null {
  // Only the beginning is searched: the rest may be megabytes.
  const start = /^data:[^,]{0,200};base64,/i.exec(uri.slice(0, 300))?.[0].length;
  if (start === undefined) return null;
  let end = uri.length;
  while (end > start && end > uri.length - 2 && uri.charCodeAt(end - 1) === 0x3d) end--;
  const length = end - start;
  if (length % 4 === 1) return null;
  const bytes = new Uint8Array(Math.floor((length * 3) / 4));
  let at = 0;
  let bits = 0;
  let isValid = true;
  for (let i = 0; i < length; i++) {
    const code = uri.charCodeAt(start + i);
    const value = code < 128 ? VALUES[code] : 255;
    if (value === 255) isValid = false;
    bits = (bits << 6) | value;
    if (i % 4 !== 0) bytes[at++] = bits >> (6 - 2 * (i % 4));
  }
  return isValid ? bytes : null;
}
