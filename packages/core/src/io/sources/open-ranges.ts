import { FIRST_PIECE, piecePath } from '../../data/bricks/brick-files.ts';
import { InvalidArgumentError, SplatFileError } from '../../data/errors.ts';
import type { FewRequests } from './few-requests.ts';
import { leadingPath, withPaths } from './open-files.ts';
import { openUrlPieces } from './open-url-pieces.ts';
import { openUrlRanges } from './open-url-ranges.ts';
import { blobRanges, type RangeSource } from './range-source.ts';
import { bytesOf, fileNamesOf, isBlob, isFiles, isStream, sourceName } from './source-kind.ts';
import type { ReadOptions, SceneFiles, SplatSource } from './splat-source.ts';

/**
 * Opens a source for its parts. Memory is not copied.
 *
 * @param firstBytes that are read at once, from the beginning.
 * @param requests of the scene that the file belongs to; by default it is the whole scene.
 *
 * Rejects as `RangeSource.read`, and with InvalidArgumentError for streams, and what is no source;
 * of pieces with SplatFileError 'missing-part' where one between the first and the last is not there.
 */
export async function openRanges(
  source: SplatSource,
  firstBytes: number,
  options: Pick<ReadOptions, 'name' | 'signal' | 'request'> = {},
  requests?: FewRequests,
): Promise<RangeSource> {
  options.signal?.throwIfAborted();
  if (typeof source === 'string' || source instanceof URL) {
    const url = String(source);
    if (fileNamesOf(url, {}).some((name) => FIRST_PIECE.test(name))) return openUrlPieces(url, options);
    return openUrlRanges(url, firstBytes, options, requests);
  }
  const { name = sourceName(source) } = options;
  if (isFiles(source)) return blobRanges(leadingFile(source), name);
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

/** The file that leads to the others; all as one, where that is the first of its pieces. */
function leadingFile(source: SceneFiles): Blob {
  const first = leadingPath(source);
  const { files, paths } = withPaths(source);
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
