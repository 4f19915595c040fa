import { shRestBasis } from '../data/splats/spherical-harmonics.ts';
import type { ShDegree } from '../data/splats/splat-set.ts';

const C0 = Math.sqrt(1 / (4 * Math.PI));

/**
 * Evaluates the colour seen along the unit vector `direction`, from the camera to the splat, in the
 * cloud's space.
 *
 * @param dc three coefficients of degree 0.
 * @param rest 3K coefficients above degree 0, each as r, g, b.
 * @returns r, g, b in the space the scene was trained in (sRGB-encoded), not negative, not limited
 *   above.
 */
export function shColor(
  degree: ShDegree,
  dc: ArrayLike<number>,
  rest: ArrayLike<number>,
  direction: readonly [number, number, number],
): [number, number, number] {
  const basis = shRestBasis(degree, ...direction);
  const color: [number, number, number] = [0, 0, 0];
  for (let channel = 0; channel < 3; channel++) {
    let sum = 0.5 + C0 * dc[channel];
    for (let k = 0; k < basis.length; k++) sum += basis[k] * rest[3 * k + channel];
    // A negative radiance has no meaning, and would darken the splats behind it.
    color[channel] = Math.max(0, sum);
  }
  return color;
}
