import fc from 'fast-check';
import { describe, expect, test } from 'vitest';
import { HALF_MAX } from '../layout/half.ts';
import { shRestBasis } from '../reference/spherical-harmonics.ts';
import { SH_REST_COEFFICIENTS, type ShDegree } from '../splats/splat-set.ts';
import { uniform } from '../testing/uniform.ts';
import {
  coefficientsPerSplat,
  type PackedHarmonics,
  packCoefficients,
  readCoefficients,
  repackHarmonics,
  shBandReach,
  shWordsPerSplat,
  truncateHarmonics,
} from './harmonics.ts';
import type { ShPrecision } from './precision.ts';

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
    fc.array(values, { minLength: coefficientsPerSplat(degree), maxLength: coefficientsPerSplat(degree) });
  // Rows of which even the largest value is among binary16's subnormals, where its steps are coarse, or below them.
  const row = fc.oneof(rowOf(value), rowOf(uniform(-1e-6, 1e-6).map(Math.fround)));
  return fc.array(row, { minLength: 1, maxLength: 5 });
}

function packed(degree: ShDegree, precision: ShPrecision, rows: readonly number[][]): PackedHarmonics {
  const wordsPerSplat = shWordsPerSplat(degree, precision);
  // Filled with garbage: packing must not depend on what was there.
  const words = new Uint32Array(rows.length * wordsPerSplat).fill(0xa5a5a5a5);
  for (const [i, row] of rows.entries()) packCoefficients(degree, precision, row, words, i * wordsPerSplat);
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
    expect(DEGREES.map((degree) => shWordsPerSplat(degree, 'f32'))).toEqual([0, 9, 24, 45]);
    expect(DEGREES.map((degree) => shWordsPerSplat(degree, 'f16'))).toEqual([0, 5, 12, 23]);
    expect(DEGREES.map((degree) => shWordsPerSplat(degree, 'u8'))).toEqual([0, 3, 7, 12]);
  });

  for (const degree of DEGREES) {
    for (const precision of PRECISIONS) {
      test(`degree ${degree}, ${precision}: any splat comes back within half a step`, () => {
        fc.assert(
          fc.property(splats(degree), (rows) => {
            const rest = packed(degree, precision, rows);
            const values = new Float64Array(coefficientsPerSplat(degree));
            for (const [i, row] of rows.entries()) {
              readCoefficients(rest, i, values);
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
      readCoefficients(packed(1, precision, [[1e9, -1e9, 1, 0, 0, 0, 0, 0, 0]]), 0, values);
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
      const again = repackHarmonics(exact, 2, precision);
      const { bandReach, ...expected } = packed(
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
        fc.property(splats(3), fc.constantFrom(...DEGREES), (rows, degree) => {
          const whole = packed(3, precision, rows);
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
          const part = truncateHarmonics(packed(3, precision, padded), rows.length, degree);
          expect(part).toMatchObject(packed(degree, precision, rows));
        }),
      );
    });
  }

  test('are the very same object where there are no others', () => {
    const whole = packed(1, 'f32', [[1, 2, 3, 4, 5, 6, 7, 8, 9]]);
    expect(truncateHarmonics(whole, 1, 1)).toBe(whole);
    expect(truncateHarmonics(whole, 1, 3)).toBe(whole);
  });
});

const rowsOfDegree = (degree: ShDegree) => splats(degree).map((rows) => ({ degree, rows }));

/** Unit vectors spread evenly over the sphere. */
const DIRECTIONS = Array.from({ length: 400 }, (_, i) => {
  const z = 1 - (2 * i + 1) / 400;
  const angle = i * Math.PI * (3 - Math.sqrt(5));
  const radius = Math.sqrt(1 - z * z);
  return [radius * Math.cos(angle), radius * Math.sin(angle), z] as const;
});

/** What `band` adds to a channel of a splat with these values, seen along `direction`. */
function bandChange(
  row: ArrayLike<number>,
  band: ShDegree,
  channel: number,
  direction: readonly [number, number, number],
): number {
  const from = SH_REST_COEFFICIENTS[(band - 1) as ShDegree];
  const basis = shRestBasis(band, ...direction);
  let sum = 0;
  for (let k = from; k < basis.length; k++) sum += basis[k] * row[3 * k + channel];
  return sum;
}

describe('how far a band reaches', () => {
  const BANDS: readonly ShDegree[] = [1, 2, 3];
  const CHANNELS = [0, 1, 2];

  test('is never exceeded, nor missed by more than the root of its number of coefficients', () => {
    fc.assert(
      fc.property(splats(3), (rows) => {
        const reach = shBandReach(packed(3, 'f32', rows), rows.length);
        expect(reach).toHaveLength(3);
        for (const band of BANDS) {
          const changes = rows.flatMap((row) =>
            CHANNELS.flatMap((channel) => DIRECTIONS.map((d) => Math.abs(bandChange(row, band, channel, d)))),
          );
          const most = Math.max(...changes);
          expect(most).toBeLessThanOrEqual(reach[band - 1] * (1 + 1e-9));
          // The rest is for the directions in between.
          expect(most).toBeGreaterThanOrEqual((0.99 * reach[band - 1]) / Math.sqrt(2 * band + 1));
        }
      }),
      { numRuns: 30 },
    );
  });

  test('is attained by the splat that is made for a direction', () => {
    fc.assert(
      fc.property(
        fc.constantFrom(...BANDS),
        fc.constantFrom(...CHANNELS),
        fc.constantFrom(...DIRECTIONS),
        uniform(-10, 10),
        (band, channel, direction, size) => {
          const row = new Array<number>(45).fill(0);
          const basis = shRestBasis(band, ...direction);
          for (let k = SH_REST_COEFFICIENTS[(band - 1) as ShDegree]; k < basis.length; k++)
            row[3 * k + channel] = Math.fround(size * basis[k]);
          const reach = shBandReach(packed(3, 'f32', [new Array<number>(45).fill(0), row]), 2);
          const change = Math.abs(bandChange(row, band, channel, direction));
          // The steps of float32 end somewhere.
          expect(Math.abs(reach[band - 1] - change)).toBeLessThanOrEqual(1e-6 * change + 2 ** -145);
          expect(reach.filter((each) => each !== 0).length).toBeLessThanOrEqual(1);
        },
      ),
    );
  });

  test('is that of the coefficients before they were rounded, whatever they are repacked to', () => {
    // What a byte next to the 1 cannot hold.
    const row = [1, ...new Array<number>(43).fill(0), 0.002];
    const exact = packed(3, 'f32', [row.map(Math.fround)]);
    const reach = shBandReach(exact, 1);
    expect(reach[2]).toBeCloseTo(Math.sqrt(7 / (4 * Math.PI)) * 0.002, 9);
    for (const precision of PRECISIONS)
      expect(shBandReach(repackHarmonics(exact, 1, precision), 1)).toEqual(reach);
    expect(shBandReach(packed(3, 'u8', [row]), 1)[2]).toBe(0);
    expect(shBandReach(packed(0, 'u8', [[]]), 1)).toEqual([]);
  });
});
