import { describe, expect, test } from 'vitest';
import { readCoefficients } from '../../../data/packing/harmonics.ts';
import { coefficientsPerSplat } from '../../../data/splats/splat-set.ts';
import { randomSplats } from '../../../testing/random-splats.ts';
import { joinRecords, recordsOf, splatsOfRecords } from './brick-records.ts';

describe('joined records', () => {
  test('have the origin and the degree of all, in order', () => {
    const sets = [
      randomSplats({ count: 3, shDegree: 2, seed: 1, origin: [8, -4, 2] }),
      randomSplats({ count: 4, shDegree: 1, seed: 2, origin: [8, -4, 2] }),
      randomSplats({ count: 2, shDegree: 2, seed: 3, origin: [9, 16, -2] }),
    ];
    const facts = { origin: [8, -4, 2], degree: 2 } as const;
    const joined = joinRecords(sets.map(recordsOf), facts);
    const order = Uint32Array.from({ length: 9 }, (_, i) => i);
    const splats = splatsOfRecords(joined, order, facts);
    let at = 0;
    for (const { count, origin, positions, logScales, harmonics } of sets) {
      const own = new Float64Array(coefficientsPerSplat(harmonics.degree));
      const values = new Float64Array(coefficientsPerSplat(2));
      for (let i = 0; i < count; i++, at++) {
        for (let axis = 0; axis < 3; axis++) {
          const expected = positions[3 * i + axis] + origin[axis] - facts.origin[axis];
          expect(splats.positions[3 * at + axis]).toBeCloseTo(expected, 5);
        }
        expect(splats.logScales.subarray(3 * at, 3 * at + 3)).toEqual(logScales.subarray(3 * i, 3 * i + 3));
        readCoefficients(harmonics, i, own);
        readCoefficients(splats.harmonics, at, values);
        for (const [k, value] of values.entries())
          expect(Math.abs(value - (own[k] ?? 0))).toBeLessThan(0.3 / 127);
      }
    }
  });

  test('of one run that has the layout are its own, not copied', () => {
    const records = recordsOf(randomSplats({ count: 3, shDegree: 1 }));
    expect(joinRecords([records], { origin: [0, 0, 0], degree: 1 })).toBe(records.words);
  });
});
