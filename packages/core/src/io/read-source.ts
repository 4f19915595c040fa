import type { PackedHarmonics } from '../packing/harmonics.ts';
import type { SplatSet } from '../splats/splat-set.ts';
import { detectFormat, SNIFF_BYTES } from './detect.ts';
import { openSource, peekSource } from './open-source.ts';
import type { ReadSplatsOptions, SplatSource } from './splat-source.ts';

/**
 * Does what `readSplats` promises. It is a module of its own, with all code that knows formats: a page whose worker
 * reads never fetches it.
 */
export async function readSource(
  source: SplatSource,
  options: ReadSplatsOptions = {},
): Promise<SplatSet<PackedHarmonics>> {
  const { signal, onProgress, shPrecision = 'u8' } = options;
  const opened = await openSource(source, options);
  const { firstBytes, source: whole } = await peekSource(opened, SNIFF_BYTES, signal);
  try {
    return await detectFormat(firstBytes, whole.name).read(whole, { shPrecision, signal, onProgress });
  } catch (error) {
    // A source of unknown format has no reader that would release it.
    if (!whole.stream.locked) whole.stream.cancel(error).catch(() => {});
    throw error;
  }
}
