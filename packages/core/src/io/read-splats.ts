import type { ShPrecision } from '../layout/sh-rest.ts';
import type { SplatSet } from '../scene/splat-set.ts';
import { detectFormat, SNIFF_BYTES } from './detect.ts';
import { openSource, peekSource } from './open-source.ts';
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
  const { signal, onProgress, shPrecision = 'u8' } = options;
  const opened = await openSource(source, options);
  const { firstBytes, source: whole } = await peekSource(opened, SNIFF_BYTES, signal);
  try {
    return await detectFormat(firstBytes, whole.name).read(whole, { shPrecision, signal, onProgress });
  } catch (error) {
    // What has no format has no reader that would let go of it.
    if (!whole.stream.locked) whole.stream.cancel(error).catch(() => {});
    throw error;
  }
}
