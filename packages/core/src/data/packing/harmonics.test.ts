import fc from 'fast-check';
import { describe, expect, test } from 'vitest';
import type { SplatEngine } from '../../engine.ts';
import type { readSplats } from '../../io/loading/read-splats.ts';
import { coefficientRows, packedRows } from '../../testing/coefficient-rows.ts';
import { HALF_MAX } from '../layout/half.ts';
import {
  coefficientsPerSplat,
  type ShDegree,
  type SplatSet,
  type TrainedHarmonics,
} from '../splats/splat-set.ts';
import {
  type Harmonics,
  type PackedHarmonics,
  readCoefficients,
  type StoredHarmonics,
  shWordsPerSplat,
} from './harmonics.ts';
import { type PackedCloud, packCloud } from './packed-cloud.ts';
import type { OwnShPrecision } from './precision.ts';

const DEGREES: readonly ShDegree[] = [0, 1, 2, 3];
const PRECISIONS: readonly OwnShPrecision[] = ['f32', 'f16', 'u8'];

/** How far a value may be from the packed one. */
function bound(precision: OwnShPrecision, value: number, row: readonly number[]): number {
  if (precision === 'f32') return 0;
  // Half a step of binary16: 2^-11 of the value, 2^-25 among the subnormals.
  if (precision === 'f16') return Math.max(Math.abs(value) * 2 ** -11, 2 ** -25);
  const largest = Math.max(...row.map(Math.abs));
  // Half a step of the scale, the largest value rounded up to binary16 by at most 2^-10, or 2^-24.
  return (0.5 / 127) * (largest * (1 + 2 ** -10) + 2 ** -24) * (1 + 1e-12);
}

describe('coefficients above degree 0', () => {
  test('take the documented number of words', () => {
    expect(DEGREES.map((degree) => shWordsPerSplat(degree, 'f32'))).toEqual([0, 9, 24, 45]);
    expect(DEGREES.map((degree) => shWordsPerSplat(degree, 'f16'))).toEqual([0, 5, 12, 23]);
    expect(DEGREES.map((degree) => shWordsPerSplat(degree, 'u8'))).toEqual([0, 3, 7, 12]);
  });

  for (const degree of DEGREES.slice(1)) {
    for (const precision of PRECISIONS) {
      test(`degree ${degree}, ${precision}: any splat comes back within half a step`, () => {
        fc.assert(
          fc.property(coefficientRows(degree), (rows) => {
            const rest = packedRows(degree, precision, rows);
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
      readCoefficients(packedRows(1, precision, [[1e9, -1e9, 1, 0, 0, 0, 0, 0, 0]]), 0, values);
      expect(values[0]).toBeCloseTo(HALF_MAX);
      expect(values[1]).toBeCloseTo(-HALF_MAX);
    }
  });
});

describe('the type of a set', () => {
  // Checked by the compiler; a line that is no error makes the next `tsc` fail.
  test('says whether its harmonics are as trained or packed', () => {
    const words = new Uint32Array(9);
    const coefficients = new Float32Array(9);
    const trained: TrainedHarmonics = { degree: 1, coefficients };
    const packed: PackedHarmonics = { degree: 1, precision: 'f32', wordsPerSplat: 9, words };
    const taken: readonly Harmonics[] = [trained, packed];
    expect(taken).toHaveLength(2);

    // @ts-expect-error words are not coefficients
    const wordsAsTrained: TrainedHarmonics = { degree: 1, coefficients: words };
    // @ts-expect-error coefficients are not words
    const coefficientsAsPacked: PackedHarmonics = { ...packed, words: coefficients };
    // @ts-expect-error words without their precision
    const halfPacked: Harmonics = { degree: 1, words };
    // @ts-expect-error packed harmonics are not as trained
    const packedAsTrained: TrainedHarmonics = packed;
    // @ts-expect-error harmonics as trained are not packed
    const trainedAsPacked: PackedHarmonics = trained;
    expect([wordsAsTrained, coefficientsAsPacked, halfPacked, packedAsTrained, trainedAsPacked]).toHaveLength(
      5,
    );

    const pass = (
      made: SplatSet,
      read: Awaited<ReturnType<typeof readSplats>>,
      cloud: PackedCloud,
      engine: SplatEngine,
    ) => {
      for (const set of [made, read]) {
        engine.add(set);
        packCloud(set, { geometryPrecision: 'packed' });
      }
      engine.add({ ...made, harmonics: packed });
      const uploaded: StoredHarmonics = cloud.harmonics;
      // @ts-expect-error what is read is packed
      const readAsTrained: SplatSet = read;
      // @ts-expect-error what is made is not
      const madeAsPacked: SplatSet<PackedHarmonics> = made;
      // @ts-expect-error words are not harmonics of any kind
      engine.add({ ...made, harmonics: { degree: 1, words } });
      return [uploaded, readAsTrained, madeAsPacked];
    };
    expect(pass).toBeTypeOf('function');
  });
});
