import type { ShPrecision } from '../packing/sh-rest.ts';
import type { SplatSet } from '../splats/splat-set.ts';
import type { ReadOptions, SplatSource } from './splat-source.ts';

export interface ReadSplatsOptions extends ReadOptions {
  /** Precision to store the spherical harmonics above degree 0 in; default `u8`. */
  readonly shPrecision?: ShPrecision;
}

/**
 * Reads splats in the calling thread, whatever the source and its format. Works in pages, workers and Node.
 *
 * Rejects with `SplatSourceError` (cannot be fetched or read), `SplatFileError` (cannot be understood; says where),
 * `InvalidArgumentError` (not a source), or the signal's reason.
 */
export async function readSplats(source: SplatSource, options: ReadSplatsOptions = {}): Promise<SplatSet> {
  const { readSource } = await import('./read-source.ts');
  return readSource(source, options);
}
