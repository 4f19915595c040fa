import { fetched } from '../../data/errors.ts';
import type { OnPiece } from '../formats/read-format.ts';
import { knownSource } from '../sources/known-source.ts';
import type { ReadSplatsOptions, SplatSource } from '../sources/splat-source.ts';

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
