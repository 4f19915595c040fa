import { logitOfShare } from '../../../data/splats/color-values.ts';
import { ROW_SLOT } from '../../../data/splats/splat-row.ts';

/**
 * Property of Mip-Splatting and Gaussian Opacity Fields: the standard deviation of each splat's 3D
 * smoothing filter. Scales and opacities in the file do not include it.
 */
export const FILTER_PROPERTY = 'filter_3D';

/** See `FileFacts`. */
export const FILTER_NOTE = 'Its filter_3D (Mip-Splatting) is fused into its scales and opacities.';

/**
 * Fuses a splat's smoothing filter f into its first `axes` scales s and its opacity, as the
 * trainers do at rendering. A scale becomes √(s² + f²); the opacity is multiplied by √(∏s² / ∏(s² +
 * f²)). The computation uses logarithms, so nothing overflows, and opacities near 0 or 1 keep their
 * precision.
 *
 * @param row see `ROW_SLOT`.
 * @param filter standard deviation, its sign ignored. If it is not finite, the scales become NaN or
 *   infinite, and the row is dropped.
 */
export function fuseFilter(row: Float64Array, axes: number, filter: number): void {
  const logFilter = Math.log(Math.abs(filter));
  if (logFilter === Number.NEGATIVE_INFINITY) return;
  /** Log of the opacity factor, at most 0. */
  let logShare = 0;
  for (let slot = ROW_SLOT.logScale; slot < ROW_SLOT.logScale + axes; slot++) {
    const logScale = row[slot];
    const fused = halfLogOfSquares(logScale, logFilter);
    logShare += logScale - fused;
    row[slot] = fused;
  }
  row[ROW_SLOT.opacity] = logitOfShare(row[ROW_SLOT.opacity], logShare);
}

/** log √(e^2a + e^2b). */
function halfLogOfSquares(a: number, b: number): number {
  const larger = Math.max(a, b);
  return larger + Math.log1p(Math.exp(2 * (Math.min(a, b) - larger))) / 2;
}
