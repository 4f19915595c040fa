import fc from 'fast-check';
import { type PackedHarmonics, packCoefficients, shWordsPerSplat } from '../data/packing/harmonics.ts';
import type { OwnShPrecision } from '../data/packing/precision.ts';
import { coefficientsPerSplat, type ShDegree } from '../data/splats/splat-set.ts';
import { uniform } from './uniform.ts';

/** Coefficients of splats of one degree, a row each, of many orders of magnitude; some are zero. */
export function coefficientRows(degree: ShDegree): fc.Arbitrary<number[][]> {
  const length = coefficientsPerSplat(degree);
  const value = fc.oneof(
    uniform(-4, 4).map(Math.fround),
    uniform(-1e4, 1e4).map(Math.fround),
    uniform(-1e-4, 1e-4).map(Math.fround),
    fc.constant(0),
  );
  const rowOf = (values: fc.Arbitrary<number>) => fc.array(values, { minLength: length, maxLength: length });
  // Rows whose largest value is among binary16's coarse subnormals, or below them.
  const row = fc.oneof(rowOf(value), rowOf(uniform(-1e-6, 1e-6).map(Math.fround)));
  return fc.array(row, { minLength: 1, maxLength: 5 });
}

export function packedRows(
  degree: ShDegree,
  precision: OwnShPrecision,
  rows: readonly number[][],
): PackedHarmonics {
  const wordsPerSplat = shWordsPerSplat(degree, precision);
  // Filled with garbage: packing must not depend on the previous contents.
  const words = new Uint32Array(rows.length * wordsPerSplat).fill(0xa5a5a5a5);
  for (const [i, row] of rows.entries()) packCoefficients(degree, precision, row, words, i * wordsPerSplat);
  return { degree, precision, wordsPerSplat, words };
}
