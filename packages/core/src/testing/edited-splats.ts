import { expect } from 'vitest';
import { InvalidArgumentError } from '../data/errors.ts';
import { type Harmonics, readCoefficients } from '../data/packing/harmonics.ts';
import { coefficientsPerSplat, type SplatSet } from '../data/splats/splat-set.ts';

/** Coefficients above degree 0 of one splat. */
export function coefficientsOf({ harmonics }: SplatSet<Harmonics>, splat: number): Float64Array {
  const values = new Float64Array(coefficientsPerSplat(harmonics.degree));
  readCoefficients(harmonics, splat, values);
  return values;
}

/** Centres in the scene's space, 3N. */
export function centersOf({ positions, origin }: SplatSet<Harmonics>): number[] {
  return Array.from(positions, (value, i) => value + origin[i % 3]);
}

/** A column-major 3×3 matrix times a vector. */
export function applied(m: Float64Array, [x, y, z]: readonly number[]): number[] {
  return [0, 1, 2].map((axis) => m[axis] * x + m[3 + axis] * y + m[6 + axis] * z);
}

/** Expects an InvalidArgumentError that names `argument`. */
export function expectInvalid(argument: string, work: () => unknown): void {
  expect(work).toThrow(InvalidArgumentError);
  expect(work).toThrow(expect.objectContaining({ argument }));
}
