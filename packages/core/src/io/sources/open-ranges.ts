import { FIRST_PIECE, piecePath } from '../../data/bricks/brick-files.ts';
import { InvalidArgumentError, SplatFileError } from '../../data/errors.ts';
import type { FewRequests } from './few-requests.ts';
import { addressName, bytesOf, type KnownSource } from './known-source.ts';
import { leadingPath } from './open-files.ts';
import { openUrlPieces } from './open-url-pieces.ts';
import { openUrlRanges } from './open-url-ranges.ts';
import { blobRanges, type RangeSource } from './range-source.ts';
import type { ReadOptions, SceneFiles } from './splat-source.ts';

/**
 * Opens a source for reads of byte ranges. Buffers are not copied.
 *
 * Rejects as `RangeSource.read`, and with InvalidArgumentError if the source is a stream or
 * invalid. Pieces of a file reject with SplatFileError 'missing-part' if a piece between the first
 * and the last is missing.
 *
 * @param firstBytes number of bytes to read at once, from the beginning.
 * @param requests request queue of the scene. Default: a new one, for a scene of one file.
 */
export async function openRanges(
  source: KnownSource,
  firstBytes: number,
  options: Pick<ReadOptions, 'signal' | 'request'> = {},
  requests?: FewRequests,
): Promise<RangeSource> {
  options.signal?.throwIfAborted();
  const { name } = source;
  switch (source.kind) {
    case 'url': {
      const isCut = FIRST_PIECE.test(addressName(source.url));
      const named = { ...options, name };
      return isCut
        ? openUrlPieces(source.url, named)
        : openUrlRanges(source.url, firstBytes, named, requests);
    }
    case 'files':
      return blobRanges(leadingFile(source), name);
    case 'blob':
      return blobRanges(source.blob, name);
    case 'bytes': {
      const bytes = bytesOf(source.bytes) as Uint8Array<ArrayBuffer>;
      const read: RangeSource['read'] = async (offset, byteCount, signal) => {
        signal?.throwIfAborted();
        return bytes.subarray(offset, offset + byteCount);
      };
      return { name, totalBytes: bytes.length, read };
    }
    default: {
      const advice = 'Pass an address, a Blob or a buffer';
      const message = `source is a ${source.kind}, of which no part can be read by itself. ${advice}.`;
      throw new InvalidArgumentError('source', message);
    }
  }
}

/** The leading file; if it is the first piece of a file, all pieces joined. */
function leadingFile(source: Required<SceneFiles>): Blob {
  const first = leadingPath(source);
  const { files, paths } = source;
  const byPath = new Map(files.map((file, i) => [paths[i], file]));
  if (!FIRST_PIECE.test(first)) return byPath.get(first)!;
  const stem = piecePath(first, '');
  const count = paths.filter((path) => path.startsWith(stem) && /^\d+$/.test(path.slice(stem.length))).length;
  const pieces = Array.from({ length: count }, (_, index) => {
    const piece = byPath.get(piecePath(first, index));
    if (piece) return piece;
    const message = `${piecePath(first, index)} is not among the files that were opened. Open all pieces together.`;
    throw new SplatFileError('missing-part', first, message);
  });
  return new Blob(pieces);
}
