import type { ShDegree } from './splat-set.ts';

const C1 = Math.sqrt(3 / (4 * Math.PI));
const C2_XY = Math.sqrt(15 / (4 * Math.PI));
const C2_ZZ = Math.sqrt(5 / (16 * Math.PI));
const C3_XXX = Math.sqrt(35 / (32 * Math.PI));
const C3_XYZ = Math.sqrt(105 / (4 * Math.PI));
const C3_XZZ = Math.sqrt(21 / (32 * Math.PI));
const C3_ZZZ = Math.sqrt(7 / (16 * Math.PI));

/** Real spherical harmonics of degrees 1 to `degree` at the unit vector x, y, z, as trained. */
export function shRestBasis(degree: ShDegree, x: number, y: number, z: number): number[] {
  const basis: number[] = [];
  if (degree >= 1) basis.push(-C1 * y, C1 * z, -C1 * x);
  if (degree >= 2) {
    basis.push(
      C2_XY * x * y,
      -C2_XY * y * z,
      C2_ZZ * (2 * z * z - x * x - y * y),
      -C2_XY * x * z,
      (C2_XY / 2) * (x * x - y * y),
    );
  }
  if (degree >= 3) {
    basis.push(
      -C3_XXX * y * (3 * x * x - y * y),
      C3_XYZ * x * y * z,
      -C3_XZZ * y * (4 * z * z - x * x - y * y),
      C3_ZZZ * z * (2 * z * z - 3 * x * x - 3 * y * y),
      -C3_XZZ * x * (4 * z * z - x * x - y * y),
      (C3_XYZ / 2) * z * (x * x - y * y),
      -C3_XXX * x * (x * x - 3 * y * y),
    );
  }
  return basis;
}
