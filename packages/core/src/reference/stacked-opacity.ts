/** Alpha of a splat at a Gaussian value, 0…1. An opacity above 1 marks a merged splat. */
export function stackedAlpha(opacity: number, gaussian: number): number {
  return opacity > 1 ? -Math.expm1(opacity * Math.log1p(-gaussian)) : opacity * gaussian;
}

const STACK_LOSS = 0.5;

/** Opacity of a splat that is spread over 1/`share` times its area. */
export function thinnedOpacity(opacity: number, share: number): number {
  return opacity <= 1 ? share * opacity : share * opacity ** (1 - STACK_LOSS * (1 - share));
}

/** Gaussian value at which a merged splat, of opacity above 1, falls to the alpha cutoff. */
export function cutoffGaussian(opacity: number, alphaCutoff: number): number {
  return -Math.expm1(Math.log1p(-alphaCutoff) / opacity);
}

/** |p|² at which a splat whose Gaussian is exp(−|p|²) has fallen to the cutoff. */
export function reachSquared(opacity: number, alphaCutoff: number): number {
  return opacity > 1 ? -Math.log(cutoffGaussian(opacity, alphaCutoff)) : Math.log(opacity / alphaCutoff);
}
