/**
 * Natural logarithm of a scale that stands for none at all: 2e-9, so thin beside its splat that
 * float32 does not tell it from 0, and still finite wherever it is squared. Not less, since the
 * packed log scales of a chunk share one range of 65,536 steps.
 */
export const FLAT_LOG_SCALE = -20;

/** Logarithm of a linear scale: flat for 0; NaN, for which a row is dropped, for negative ones. */
export function logScaleOf(scale: number): number {
  return scale === 0 ? FLAT_LOG_SCALE : Math.log(scale);
}
