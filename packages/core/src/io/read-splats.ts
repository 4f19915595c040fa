import type { PackedHarmonics } from '../packing/harmonics.ts';
import type { SplatSet } from '../splats/splat-set.ts';
import type { ReadSplatsOptions, SplatSource } from './splat-source.ts';

/**
 * Reads splats in the calling thread, whatever the source and its format. Works in pages, workers and Node.
 *
 * Rejects with `SplatSourceError` (cannot be fetched or read), `SplatFileError` (cannot be understood; says where),
 * `InvalidArgumentError` (not a source), or the signal's reason.
 */
export async function readSplats(
  source: SplatSource,
  options: ReadSplatsOptions = {},
): Promise<SplatSet<PackedHarmonics>> {
  const { readSource } = await import('./read-source.ts');
  return readSource(source, options);
}
