/**
 * Natural logarithm that replaces the log scale of a flat axis: a scale of 2e-9. Next to its splat,
 * float32 cannot distinguish this scale from 0, and its square stays finite. It is not smaller
 * because the log scales of a chunk share one range of 65,536 steps.
 */
export const FLAT_LOG_SCALE = -20;

/**
 * Natural logarithm of a linear scale: FLAT_LOG_SCALE for 0, NaN for a negative one, whose row is
 * dropped.
 */
export function logScaleOf(scale: number): number {
  return scale === 0 ? FLAT_LOG_SCALE : Math.log(scale);
}
