import { SplatFileError } from '../../../data/errors.ts';
import { coefficientsPerSplat, SH_REST_COEFFICIENTS, type ShDegree } from '../../../data/splats/splat-set.ts';
import type { PlyElement } from './ply-header.ts';

const SH_DEGREES: readonly ShDegree[] = [0, 1, 2, 3];

/** The degree of the harmonics that an element has, by the number of its `f_rest` properties. */
export function shDegreeOf({ name, properties }: PlyElement, file: string): ShDegree {
  const count = properties.filter((property) => /^f_rest_\d+$/.test(property.name)).length;
  const degree = SH_DEGREES.find((candidate) => coefficientsPerSplat(candidate) === count);
  if (degree !== undefined) return degree;
  throw new SplatFileError(
    'bad-property',
    file,
    `there are ${count} f_rest properties; spherical harmonics of degree 0, 1, 2 or 3 have 0, 9, 24 or 45.`,
    { element: name },
  );
}

/** Properties of harmonics in the order of `ROW_SLOT`; files have red, then green, then blue. */
export function shNames(degree: ShDegree): string[] {
  const coefficients = SH_REST_COEFFICIENTS[degree];
  return Array.from(
    { length: 3 * coefficients },
    (_, i) => `f_rest_${(i % 3) * coefficients + Math.floor(i / 3)}`,
  );
}
