import { ROW_SLOT } from '../../../data/splats/splat-row.ts';

/**
 * Property in which Mip-Splatting, and Gaussian Opacity Fields after it, keep the standard
 * deviation of each splat's 3D smoothing filter, beside scales and opacities without it.
 */
export const FILTER_PROPERTY = 'filter_3D';

/** See `FileFacts`. */
export const FILTER_NOTE = 'Its filter_3D (Mip-Splatting) is fused into its scales and opacities.';

/**
 * Fuses the filter f of a splat into its first `axes` scales s and its opacity, as the trainers do
 * when they draw: √(s² + f²) for each scale, and the opacity times √(∏s² / ∏(s² + f²)). All is
 * computed of logarithms, so nothing overflows and no opacity near 0 or 1 is rounded to that.
 *
 * @param row see `ROW_SLOT`.
 * @param filter the sign does not count; for one that is not finite, the splat's scales are none.
 */
export function fuseFilter(row: Float64Array, axes: number, filter: number): void {
  const logFilter = Math.log(Math.abs(filter));
  if (logFilter === Number.NEGATIVE_INFINITY) return;
  /** Logarithm of the factor of the opacity: 0 or less. */
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

/** The logit of an opacity times e^logShare. */
function logitOfShare(logit: number, logShare: number): number {
  // log σ(x), without a large power of e.
  const logOpacity = Math.min(0, logit) - Math.log1p(Math.exp(-Math.abs(logit)));
  const logFused = logOpacity + logShare;
  return logFused - Math.log(-Math.expm1(logFused));
}
