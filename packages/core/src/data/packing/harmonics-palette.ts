import type { ShDegree } from '../splats/splat-set.ts';

/** Most entries of a palette: two bytes tell them apart. */
export const MAX_PALETTE_ENTRIES = 2 ** 16;

/**
 * Spherical harmonics above degree 0 of N splats that share E sets of coefficients, 1 ≤ E ≤
 * MAX_PALETTE_ENTRIES; none where there are no coefficients or no splats.
 */
export interface HarmonicsPalette {
  readonly degree: ShDegree;
  /** E × 3K in ascending (degree, order), each as r, g, b; K = SH_REST_COEFFICIENTS[degree]. */
  readonly entries: Float32Array;
  /** Entry of each of the N splats, below E. */
  readonly indices: Uint16Array;
}
