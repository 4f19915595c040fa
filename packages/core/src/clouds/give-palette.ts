import type { LoadProgress } from '../io/sources/splat-source.ts';
import { MAX_PALETTE_ENTRIES } from '../packing/harmonics-palette.ts';
import type { PackedCloud } from '../packing/packed-cloud.ts';
import { packPalette } from '../packing/repack-harmonics.ts';
import { type FindPaletteOptions, findPalette } from './find-palette.ts';

export interface GivePaletteOptions extends Pick<FindPaletteOptions, 'name' | 'isGiven' | 'signal'> {
  readonly onProgress?: (progress: Pick<LoadProgress, 'phase' | 'part'>) => void;
}

/**
 * The same cloud with a palette found for its harmonics: as many entries as a power of two has that is not above an eighth of its
 * splats, so that they take less memory than coefficients of each splat. A cloud that has a palette, or no harmonics, stays as it is.
 *
 * Rejects as `findPalette`.
 */
export async function givePalette(
  packed: PackedCloud,
  { onProgress, ...options }: GivePaletteOptions,
): Promise<PackedCloud> {
  const { harmonics, count } = packed;
  if (harmonics.precision === 'palette' || harmonics.degree === 0) return packed;
  const entryCount = Math.min(MAX_PALETTE_ENTRIES, 2 ** Math.max(0, Math.floor(Math.log2(count / 8))));
  const report = (part: number) => onProgress?.({ phase: 'palette', part });
  report(0);
  const palette = await findPalette(harmonics, count, { ...options, entryCount, onProgress: report });
  return { ...packed, harmonics: packPalette(palette, harmonics.degree) };
}
