/** Opacity of a splat where its Gaussian is `gaussian`; one above 1 is that of a merged splat. */
export function stackedAlpha(opacity: number, gaussian: number): number {
  return opacity > 1 ? -Math.expm1(opacity * Math.log1p(-gaussian)) : opacity * gaussian;
}

/** Value of the Gaussian at which a merged splat, of opacity above 1, has fallen to the cutoff. */
export function cutoffGaussian(opacity: number, alphaCutoff: number): number {
  return -Math.expm1(Math.log1p(-alphaCutoff) / opacity);
}

/** |p|² at which a splat whose Gaussian is exp(−|p|²) has fallen to the cutoff. */
export function reachSquared(opacity: number, alphaCutoff: number): number {
  return opacity > 1 ? -Math.log(cutoffGaussian(opacity, alphaCutoff)) : Math.log(opacity / alphaCutoff);
}
