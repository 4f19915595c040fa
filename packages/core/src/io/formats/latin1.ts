/** Bytes as text, one character each, for patterns that bytes are told by. */
export function latin1(bytes: Uint8Array): string {
  return Array.from(bytes, (byte) => String.fromCharCode(byte)).join('');
}
