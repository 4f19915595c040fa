import type { OnPiece } from '../formats/read-format.ts';
import type { ReadSplatsOptions, SplatSource } from '../sources/splat-source.ts';

/**
 * Reads splats in the calling thread, as `readSplats` does, and hands them on piece by piece. Files
 * that have one splat after another (PLY, `.splat`), and Blobs that are SPZ up to version 3, take a
 * few megabytes of memory; others their bytes. Harmonics that stay a palette, and points, are one
 * piece with all splats.
 *
 * Rejects as `readSplats`, and as `onPiece`.
 */
export async function readSplatPieces(
  source: SplatSource,
  options: ReadSplatsOptions,
  onPiece: OnPiece,
): Promise<void> {
  const [{ readSource }, { THREAD_READERS }] = await Promise.all([
    import('./read-source.ts'),
    import('../formats/thread-readers.ts'),
  ]);
  await onPiece(await readSource(source, { ...options, onPiece }, THREAD_READERS));
}
