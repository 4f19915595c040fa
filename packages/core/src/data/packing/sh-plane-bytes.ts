import type { ShDegree } from '../splats/splat-set.ts';
import { ENTRY_PRECISION, shWordsPerSplat } from './harmonics.ts';
import { MAX_PALETTE_ENTRIES } from './harmonics-palette.ts';
import type { ShPrecision } from './precision.ts';

/**
 * Bytes of the harmonics of `count` splats.
 *
 * @param entryCount of a palette; default as many as there can be.
 */
export function shPlaneBytes(
  count: number,
  degree: ShDegree,
  precision: ShPrecision,
  entryCount = MAX_PALETTE_ENTRIES,
): number {
  if (precision !== 'palette') return 4 * count * shWordsPerSplat(degree, precision);
  if (degree === 0) return 0;
  return 4 * (entryCount * shWordsPerSplat(degree, ENTRY_PRECISION) + Math.ceil(count / 2));
}
