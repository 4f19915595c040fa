import { fetched } from '../../data/errors.ts';
import type { PackedHarmonics, ReadHarmonics } from '../../data/packing/harmonics.ts';
import type { OwnShPrecision } from '../../data/packing/precision.ts';
import type { SplatSet } from '../../data/splats/splat-set.ts';
import type { OnPiece } from '../formats/read-format.ts';
import { knownSource } from '../sources/known-source.ts';
import type { ReadSplatsOptions, SplatSource } from '../sources/splat-source.ts';

/**
 * Reads splats in the calling thread, from any source and in any format. Works in pages, workers
 * and Node. Harmonics are packed in `options.shPrecision` while they are read.
 *
 * Rejects with `SplatSourceError` if the source cannot be fetched or read, and with
 * `SplatFileError` if the file is invalid, with the place. Rejects with `InvalidArgumentError` if
 * the value is no source, and with the signal's reason.
 *
 * @example
 * const set = await readSplats('/garden.ply');
 * const [x, y, z] = set.positions;
 */
export async function readSplats(
  source: SplatSource,
  options?: ReadSplatsOptions & { readonly shPrecision?: OwnShPrecision },
): Promise<SplatSet<PackedHarmonics>>;
export async function readSplats(
  source: SplatSource,
  options: ReadSplatsOptions,
): Promise<SplatSet<ReadHarmonics>>;
export async function readSplats(
  source: SplatSource,
  options: ReadSplatsOptions = {},
): Promise<SplatSet<ReadHarmonics>> {
  const from = knownSource(source, options);
  const [{ readSource }, { THREAD_READERS }] = await fetched(
    'loading',
    Promise.all([import('./read-source.ts'), import('../formats/thread-readers.ts')]),
  );
  return readSource(from, options, THREAD_READERS);
}

/**
 * Reads splats in the calling thread, as `readSplats` does, and passes them on in pieces.
 * Sequential files (PLY, `.splat`), and Blobs of SPZ up to version 3, take a few megabytes of
 * memory. Other files are held in memory as a whole. Points, and splats with a preserved palette,
 * form a single piece.
 *
 * Rejects as `readSplats`, and as `onPiece`.
 *
 * @example
 * let highest = Number.NEGATIVE_INFINITY;
 * await readSplatPieces(file, {}, async ({ count, positions, origin }) => {
 *   for (let i = 0; i < count; i++) highest = Math.max(highest, origin[1] + positions[3 * i + 1]);
 * });
 */
export async function readSplatPieces(
  source: SplatSource,
  options: ReadSplatsOptions,
  onPiece: OnPiece,
): Promise<void> {
  const from = knownSource(source, options);
  const [{ readSource }, { THREAD_READERS }] = await fetched(
    'loading',
    Promise.all([import('./read-source.ts'), import('../formats/thread-readers.ts')]),
  );
  await onPiece(await readSource(from, { ...options, onPiece }, THREAD_READERS));
}
