import type { ShDegree } from '../../../data/splats/splat-set.ts';

/** Splats as attributes of points. */
export const SPLATTING = 'KHR_gaussian_splatting';
/** The first draft, of Cesium's first tiles: a primitive is an .spz, which this extension names. */
export const FIRST_SPZ = 'KHR_spz_gaussian_splats_compression';

/**
 * Key in the extension's `extras` for values without a key of its own: it defines a single order,
 * by distances from the camera, and leaves others to further extensions, of which there are none.
 * Readers that do not know it take the file as the extension says.
 */
export const OWN_EXTRAS = 'websplatter';
/** The `sortBy` in them. */
export const BY_DEPTH = 'depth';

const HARMONICS_SEMANTICS = Array.from({ length: 4 }, (_, l) =>
  Array.from({ length: 2 * l + 1 }, (_, n) => `${SPLATTING}:SH_DEGREE_${l}_COEF_${n}`),
).flat();

/** Semantics of the coefficients up to a degree, in the order of rows. */
export function harmonicsSemantics(degree: ShDegree): string[] {
  return HARMONICS_SEMANTICS.slice(0, (degree + 1) ** 2);
}
