import { SplatFileError } from '../../data/errors.ts';
import type { SplatInput } from '../formats/read-format.ts';
import type { ByteReader } from './byte-reader.ts';

/** Initial capacity if the size is unknown. */
const FIRST_BYTES = 1 << 20;

/**
 * Reads up to `maxBytes` unread bytes, into memory that grows as they arrive.
 *
 * Rejects with SplatFileError 'too-large' if memory is exhausted; and as the reader.
 *
 * @param expectedBytes certain size, allocated at once.
 * @param onArrived called repeatedly with the number of bytes that have arrived.
 */
export async function readAll(
  reader: ByteReader,
  maxBytes = Number.POSITIVE_INFINITY,
  expectedBytes = 0,
  onArrived?: (loadedBytes: number) => void,
): Promise<Uint8Array<ArrayBuffer>> {
  let bytes = memoryFor(expectedBytes > 0 ? expectedBytes : Math.min(FIRST_BYTES, maxBytes), reader);
  let length = 0;
  while (length < maxBytes && (await reader.fill(1))) {
    const part = reader.bytes.subarray(
      reader.start,
      reader.start + Math.min(reader.available, maxBytes - length),
    );
    if (length + part.length > bytes.length) {
      const larger = memoryFor(Math.max(length + part.length, 2 * bytes.length), reader);
      larger.set(bytes.subarray(0, length));
      bytes = larger;
    }
    bytes.set(part, length);
    reader.advance(part.length);
    length += part.length;
    onArrived?.(length);
  }
  return bytes.subarray(0, length);
}

function memoryFor(byteCount: number, { name }: ByteReader): Uint8Array<ArrayBuffer> {
  try {
    return new Uint8Array(byteCount);
  } catch (cause) {
    if (!(cause instanceof RangeError)) throw cause;
    const advice = 'Unpack it if it is an archive, or convert it to PLY, which is read piece by piece';
    throw new SplatFileError(
      'too-large',
      name,
      `no memory for ${byteCount} bytes in one piece. ${advice}.`,
      {},
      { cause },
    );
  }
}

/**
 * Reads the next `byteCount` bytes into memory that grows as they arrive.
 *
 * Rejects with SplatFileError 'truncated' if there are fewer; before reading, if the size is known.
 *
 * @param what `the header`, `31000 splats`: the bytes, for messages.
 * @param onArrived called repeatedly while they arrive.
 */
export async function readExactly(
  { name, reader, totalBytes, totalBytesCertain, isLocal }: SplatInput,
  byteCount: number,
  what: string,
  onArrived?: () => void,
): Promise<Uint8Array<ArrayBuffer>> {
  const startByte = reader.byteOffset;
  const fail = (foundBytes: number): never => {
    throw truncated(name, what, { startByte, byteCount, foundBytes });
  };
  const leftBytes = totalBytesCertain && totalBytes !== undefined ? totalBytes - startByte : undefined;
  if (leftBytes !== undefined && leftBytes < byteCount) fail(leftBytes);
  const bytes = await readAll(
    reader,
    byteCount,
    isLocal && leftBytes !== undefined ? byteCount : 0,
    onArrived,
  );
  return bytes.length < byteCount ? fail(bytes.length) : bytes;
}

/** The error for a truncated file. */
export function truncated(
  name: string,
  what: string,
  { startByte, byteCount, foundBytes }: Readonly<Record<'startByte' | 'byteCount' | 'foundBytes', number>>,
): SplatFileError {
  const message = `${what} take ${byteCount} bytes, the file has ${foundBytes} left. Download or export it again.`;
  const place = { byte: startByte + foundBytes, expectedBytes: startByte + byteCount };
  return new SplatFileError('truncated', name, message, place);
}
