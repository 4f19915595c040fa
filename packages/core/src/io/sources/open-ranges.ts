import { InvalidArgumentError } from '../../data/errors.ts';
import { FIRST_PIECE } from '../formats/bricks/bricks-format.ts';
import { filesOf } from './open-files.ts';
import { openUrlRanges } from './open-url-ranges.ts';
import { blobRanges, type RangeSource } from './range-source.ts';
import { openUrlPieces } from './scene-pieces.ts';
import { bytesOf, fileNameOf, isBlob, isFiles, isStream, sourceName } from './source-kind.ts';
import type { ReadOptions, SplatSource } from './splat-source.ts';

/**
 * Opens a source for its parts. Memory is not copied.
 *
 * @param firstBytes that are read at once, from the beginning.
 *
 * Rejects as `RangeSource.read`, and with InvalidArgumentError for streams, and what is no source;
 * for files as `openFiles`.
 */
export async function openRanges(
  source: SplatSource,
  firstBytes: number,
  options: Pick<ReadOptions, 'name' | 'signal' | 'request'> = {},
): Promise<RangeSource> {
  options.signal?.throwIfAborted();
  if (typeof source === 'string' || source instanceof URL) {
    const url = String(source);
    if (FIRST_PIECE.test(fileNameOf(url, undefined))) return openUrlPieces(url, options);
    return openUrlRanges(url, firstBytes, options);
  }
  const { name = sourceName(source) } = options;
  if (isFiles(source)) return blobRanges(filesOf(source).leading, name);
  if (isStream(source)) {
    const advice = 'Pass an address, a Blob or a buffer';
    const message = `source is a stream, of which no part can be read by itself. ${advice}.`;
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
