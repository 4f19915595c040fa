import fc from 'fast-check';
import { describe, expect, test } from 'vitest';
import { coefficientRows, packedRows } from '../../testing/coefficient-rows.ts';
import { coefficientsPerSplat, type ShDegree } from '../splats/splat-set.ts';
import { readCoefficients, shWordsPerSplat } from './harmonics.ts';
import type { OwnShPrecision } from './precision.ts';
import { packHarmonics, repackHarmonics, truncateHarmonics } from './repack-harmonics.ts';

const DEGREES: readonly ShDegree[] = [0, 1, 2, 3];
const PRECISIONS: readonly OwnShPrecision[] = ['f32', 'f16', 'u8'];

describe('harmonics as trained', () => {
  test('are f32 words where they lie: nothing is copied', () => {
    fc.assert(
      fc.property(fc.constantFrom(...DEGREES).chain(rowsOfDegree), ({ degree, rows }) => {
        // Not at the start of its memory.
        const coefficients = Float32Array.of(7, ...rows.flat()).subarray(1);
        const harmonics = packHarmonics({ degree, coefficients });
        expect(harmonics).toEqual(packedRows(degree, 'f32', rows));
        expect(harmonics.words.buffer).toBe(coefficients.buffer);
      }),
    );
  });

  test('are copied where one has to be clamped, and stay as they are', () => {
    const row = [3e38, -3e38, 1, -0, 0, 0.5, 1e34, -1e34, 2];
    const coefficients = Float32Array.from(row);
    expect(packHarmonics({ degree: 1, coefficients })).toEqual(packedRows(1, 'f32', [row]));
    expect(coefficients).toEqual(Float32Array.from(row));
  });
});

describe('packed coefficients', () => {
  test('repacking equals unpacking and packing; the same precision is the same object', () => {
    const rows = [
      [0.1, -0.2, 0.3, 0.4, -0.5, 0.6, 0.7, 0.8, 0.9],
      [0, 0, 0, 0, 0, 0, 0, 0, 0],
    ];
    const exact = packedRows(
      1,
      'f32',
      rows.map((row) => row.map(Math.fround)),
    );
    for (const precision of PRECISIONS) {
      const again = repackHarmonics(exact, 2, precision);
      const { bandReach, ...expected } = packedRows(
        1,
        precision,
        rows.map((row) => row.map(Math.fround)),
      );
      expect(again).toMatchObject(expected);
      expect(repackHarmonics(again, 2, precision)).toBe(again);
    }
  });
});

describe('the first bands alone', () => {
  for (const precision of PRECISIONS) {
    test(`${precision}: have the values that they had among all`, () => {
      fc.assert(
        fc.property(coefficientRows(3), fc.constantFrom(...DEGREES), (rows, degree) => {
          const whole = packedRows(3, precision, rows);
          const part = truncateHarmonics(whole, rows.length, degree);
          expect(part).toMatchObject({
            degree,
            precision,
            wordsPerSplat: shWordsPerSplat(degree, precision),
          });
          const [wholeValues, values] = [
            new Float64Array(45),
            new Float64Array(coefficientsPerSplat(degree)),
          ];
          for (const i of rows.keys()) {
            readCoefficients(whole, i, wholeValues);
            readCoefficients(part, i, values);
            expect(values).toEqual(wholeValues.subarray(0, values.length));
          }
        }),
      );
    });

    test(`${precision}: are word for word a file of their degree where the others are zero`, () => {
      fc.assert(
        fc.property(fc.constantFrom(...DEGREES).chain(rowsOfDegree), ({ degree, rows }) => {
          const padded = rows.map((row) => [...row, ...new Array<number>(45 - row.length).fill(0)]);
          const part = truncateHarmonics(packedRows(3, precision, padded), rows.length, degree);
          expect(part).toMatchObject(packedRows(degree, precision, rows));
        }),
      );
    });
  }

  test('are the very same object where there are no others', () => {
    const whole = packedRows(1, 'f32', [[1, 2, 3, 4, 5, 6, 7, 8, 9]]);
    expect(truncateHarmonics(whole, 1, 1)).toBe(whole);
    expect(truncateHarmonics(whole, 1, 3)).toBe(whole);
  });
});

const rowsOfDegree = (degree: ShDegree) => coefficientRows(degree).map((rows) => ({ degree, rows }));
