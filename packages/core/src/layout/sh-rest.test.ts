import fc from 'fast-check';
import { describe, expect, test } from 'vitest';
import type { ShDegree } from '../scene/splat-set.ts';
import { uniform } from '../testing/uniform.ts';
import { HALF_MAX } from './half.ts';
import {
  packShRest,
  repackShRest,
  type ShPrecision,
  type ShRest,
  shRestValues,
  shRestWordsPerSplat,
  unpackShRest,
} from './sh-rest.ts';

const DEGREES: readonly ShDegree[] = [0, 1, 2, 3];
const PRECISIONS: readonly ShPrecision[] = ['f32', 'f16', 'u8'];

/** Splats of one degree whose coefficients span many orders of magnitude, and of which some are exactly zero. */
function splats(degree: ShDegree) {
  const value = fc.oneof(
    uniform(-4, 4).map(Math.fround),
    uniform(-1e4, 1e4).map(Math.fround),
    uniform(-1e-4, 1e-4).map(Math.fround),
    fc.constant(0),
  );
  const rowOf = (values: fc.Arbitrary<number>) =>
    fc.array(values, { minLength: shRestValues(degree), maxLength: shRestValues(degree) });
  // Rows of which even the largest value is among binary16's subnormals, where its steps are coarse, or below them.
  const row = fc.oneof(rowOf(value), rowOf(uniform(-1e-6, 1e-6).map(Math.fround)));
  return fc.array(row, { minLength: 1, maxLength: 5 });
}

function packed(degree: ShDegree, precision: ShPrecision, rows: readonly number[][]): ShRest {
  const wordsPerSplat = shRestWordsPerSplat(degree, precision);
  // Filled with garbage: packing must not depend on what was there.
  const words = new Uint32Array(rows.length * wordsPerSplat).fill(0xa5a5a5a5);
  for (const [i, row] of rows.entries()) packShRest(degree, precision, row, words, i * wordsPerSplat);
  return { degree, precision, wordsPerSplat, words };
}

/** How far a value may be from what was packed. */
function bound(precision: ShPrecision, value: number, row: readonly number[]): number {
  if (precision === 'f32') return 0;
  // Half a step of binary16: 2^-11 of the value, 2^-25 among the subnormals.
  if (precision === 'f16') return Math.max(Math.abs(value) * 2 ** -11, 2 ** -25);
  const largest = Math.max(...row.map(Math.abs));
  // Half a step of the scale, which is the largest value rounded up to binary16: at most 2^-10 of it, or 2^-24, more.
  return (0.5 / 127) * (largest * (1 + 2 ** -10) + 2 ** -24) * (1 + 1e-12);
}

describe('coefficients above degree 0', () => {
  test('take the documented number of words', () => {
    expect(DEGREES.map((degree) => shRestWordsPerSplat(degree, 'f32'))).toEqual([0, 9, 24, 45]);
    expect(DEGREES.map((degree) => shRestWordsPerSplat(degree, 'f16'))).toEqual([0, 5, 12, 23]);
    expect(DEGREES.map((degree) => shRestWordsPerSplat(degree, 'u8'))).toEqual([0, 3, 7, 12]);
  });

  for (const degree of DEGREES) {
    for (const precision of PRECISIONS) {
      test(`degree ${degree}, ${precision}: any splat comes back within half a step`, () => {
        fc.assert(
          fc.property(splats(degree), (rows) => {
            const rest = packed(degree, precision, rows);
            const values = new Float64Array(shRestValues(degree));
            for (const [i, row] of rows.entries()) {
              unpackShRest(rest, i, values);
              for (const [k, value] of row.entries())
                expect(Math.abs(values[k] - value)).toBeLessThanOrEqual(bound(precision, value, row));
            }
          }),
          { numRuns: 60 },
        );
      });
    }
  }

  test('too large values are clamped, and nothing becomes infinite', () => {
    const values = new Float64Array(9);
    for (const precision of ['f16', 'u8'] as const) {
      unpackShRest(packed(1, precision, [[1e9, -1e9, 1, 0, 0, 0, 0, 0, 0]]), 0, values);
      expect(values[0]).toBeCloseTo(HALF_MAX);
      expect(values[1]).toBeCloseTo(-HALF_MAX);
    }
  });

  test('repacking is packing what was unpacked; the same precision is the same object', () => {
    const rows = [
      [0.1, -0.2, 0.3, 0.4, -0.5, 0.6, 0.7, 0.8, 0.9],
      [0, 0, 0, 0, 0, 0, 0, 0, 0],
    ];
    const exact = packed(
      1,
      'f32',
      rows.map((row) => row.map(Math.fround)),
    );
    for (const precision of PRECISIONS) {
      const again = repackShRest(exact, 2, precision);
      expect(again).toEqual(
        packed(
          1,
          precision,
          rows.map((row) => row.map(Math.fround)),
        ),
      );
      expect(repackShRest(again, 2, precision)).toBe(again);
    }
  });
});
