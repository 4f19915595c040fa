import type { ShDegree } from '../../../data/splats/splat-set.ts';

/** Extension for splats as attributes of points. */
export const SPLATTING = 'KHR_gaussian_splatting';
/** The first draft, in Cesium's first tiles: a primitive refers to an .spz by this extension. */
export const FIRST_SPZ = 'KHR_spz_gaussian_splats_compression';

/**
 * Key in the extension's `extras` for the sort order by depth. The extension defines only the order
 * by distance from the camera, and no further extension defines others. Other readers ignore the
 * key.
 */
export const OWN_EXTRAS = 'websplatter';
/** Value of `sortBy` in these extras. */
export const BY_DEPTH = 'depth';

const HARMONICS_SEMANTICS = Array.from({ length: 4 }, (_, l) =>
  Array.from({ length: 2 * l + 1 }, (_, n) => `${SPLATTING}:SH_DEGREE_${l}_COEF_${n}`),
).flat();

/** Attribute semantics of the coefficients up to a degree, in the order of rows. */
export function harmonicsSemantics(degree: ShDegree): string[] {
  return HARMONICS_SEMANTICS.slice(0, (degree + 1) ** 2);
}
