import type { ByteReader } from './byte-reader.ts';

/** Memory to begin with, where nothing is known. */
const FIRST_BYTES = 1 << 20;

/**
 * Reads up to `maxBytes` of what has not been read, into memory that grows with what arrives.
 *
 * @param expectedBytes how much it will be, as far as that is sure: memory for it is taken at once.
 */
export async function readAll(
  reader: ByteReader,
  maxBytes = Number.POSITIVE_INFINITY,
  expectedBytes = 0,
): Promise<Uint8Array<ArrayBuffer>> {
  let bytes = new Uint8Array(expectedBytes > 0 ? expectedBytes : Math.min(FIRST_BYTES, maxBytes));
  let length = 0;
  while (length < maxBytes && (await reader.fill(1))) {
    const part = reader.bytes.subarray(
      reader.start,
      reader.start + Math.min(reader.available, maxBytes - length),
    );
    if (length + part.length > bytes.length) {
      const larger = new Uint8Array(Math.max(length + part.length, 2 * bytes.length));
      larger.set(bytes.subarray(0, length));
      bytes = larger;
    }
    bytes.set(part, length);
    reader.advance(part.length);
    length += part.length;
  }
  return bytes.subarray(0, length);
}
