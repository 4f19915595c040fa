import { SplatFileError } from '../../data/errors.ts';
import type { SplatInput } from '../formats/read-format.ts';
import { readAll } from './read-all.ts';

/**
 * Reads the next `byteCount` bytes into memory that grows as they arrive.
 *
 * Rejects with SplatFileError 'truncated' if there are fewer; before reading, if the size is known.
 *
 * @param what `the header`, `31000 splats`: the bytes, for messages.
 * @param onArrived called repeatedly while they arrive.
 */
export async function readExactly(
  { name, reader, totalBytes, totalBytesCertain, isHeld }: SplatInput,
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
    isHeld && leftBytes !== undefined ? byteCount : 0,
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
