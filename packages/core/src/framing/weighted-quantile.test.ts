import fc from 'fast-check';
import { expect, test } from 'vitest';
import { weightedQuantile, weightedQuantiles } from './weighted-quantile.ts';

const rows = fc.array(fc.tuple(fc.integer({ min: -1000, max: 1000 }), fc.integer({ min: 1, max: 9 })), {
  minLength: 1,
  maxLength: 200,
});

test('a quantile is that of the sorted values, to a small part of their range', () => {
  fc.assert(
    fc.property(rows, fc.double({ min: 0.01, max: 0.99, noNaN: true }), (given, part) => {
      const values = Float64Array.from(given, ([value]) => value);
      const weights = Float64Array.from(given, ([, weight]) => weight);
      const sorted = given.toSorted(([a], [b]) => a - b);
      const total = weights.reduce((sum, weight) => sum + weight, 0);
      let at = 0;
      for (let below = sorted[0][1]; below < part * total; below += sorted[at][1]) at++;
      const expected = sorted[at][0];
      const range = sorted.at(-1)![0] - sorted[0][0];
      const found = weightedQuantile(values, weights, values.length, part);
      expect(Math.abs(found - expected)).toBeLessThanOrEqual(range / 2 ** 14 + 1e-9);
    }),
  );
});

test('several at once are the same as one by one, and equal values are theirs', () => {
  const values = Float64Array.from({ length: 100 }, (_, i) => (i * 37) % 100);
  const weights = values.map(() => 1);
  const [low, high] = weightedQuantiles(values, weights, 100, [0.25, 0.75]);
  expect([low, high]).toEqual([0.25, 0.75].map((part) => weightedQuantile(values, weights, 100, part)));
  expect(weightedQuantile(Float64Array.of(4, 4, 4), Float64Array.of(1, 2, 3), 3, 0.5)).toBe(4);
});
