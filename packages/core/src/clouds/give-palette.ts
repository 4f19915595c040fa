import { clusterHarmonics } from '../packing/cluster-harmonics.ts';
import { MAX_PALETTE_ENTRIES } from '../packing/harmonics-palette.ts';
import type { PackedCloud } from '../packing/packed-cloud.ts';
import { packPalette } from '../packing/repack-harmonics.ts';

/**
 * The same cloud with a palette found for its harmonics: as many entries as a power of two has that is not above an eighth of its
 * splats, so that they take less memory than coefficients of each splat. A cloud that has a palette, or no harmonics, stays as it is.
 *
 * Rejects with the signal's reason.
 */
export async function givePalette(packed: PackedCloud, signal: AbortSignal): Promise<PackedCloud> {
  const { harmonics, count } = packed;
  if (harmonics.precision === 'palette' || harmonics.degree === 0) return packed;
  const entryCount = Math.min(MAX_PALETTE_ENTRIES, 2 ** Math.max(0, Math.floor(Math.log2(count / 8))));
  const palette = await clusterHarmonics(harmonics, count, { entryCount, signal });
  return { ...packed, harmonics: packPalette(palette, harmonics.degree) };
}
