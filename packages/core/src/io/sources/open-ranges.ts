import { InvalidArgumentError } from '../../data/errors.ts';
import { openUrlRanges } from './open-url-ranges.ts';
import { blobRanges, type RangeSource } from './range-source.ts';
import { bytesOf, isBlob, isFiles, isStream, sourceName } from './source-kind.ts';
import type { ReadOptions, SplatSource } from './splat-source.ts';

/**
 * Opens a source for its parts. Memory is not copied.
 *
 * @param firstBytes that are read at once, from the beginning.
 *
 * Rejects as `RangeSource.read`, and with InvalidArgumentError for streams, scenes of several
 * files, and what is no source.
 */
export async function openRanges(
  source: SplatSource,
  firstBytes: number,
  options: Pick<ReadOptions, 'name' | 'signal' | 'request'> = {},
): Promise<RangeSource> {
  options.signal?.throwIfAborted();
  if (typeof source === 'string' || source instanceof URL)
    return openUrlRanges(String(source), firstBytes, options);
  const { name = sourceName(source) } = options;
  if (isStream(source) || isFiles(source)) {
    const found = isStream(source) ? 'a stream' : 'a list of files';
    const message = `source is ${found}, of which no part can be read by itself. Pass an address, a Blob or a buffer.`;
    throw new InvalidArgumentError('source', message);
  }
  if (isBlob(source)) return blobRanges(source, name);
  const bytes = bytesOf(source as ArrayBuffer | ArrayBufferView) as Uint8Array<ArrayBuffer>;
  return {
    name,
    totalBytes: bytes.length,
    read: async (offset, byteCount, signal) => {
      signal?.throwIfAborted();
      return bytes.subarray(offset, offset + byteCount);
    },
  };
}
