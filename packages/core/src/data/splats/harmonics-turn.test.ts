import fc from 'fast-check';
import { expect, test } from 'vitest';
import { HarmonicsTurn } from './harmonics-turn.ts';
import { shRestBasis } from './spherical-harmonics.ts';
import { coefficientsPerSplat, type ShDegree } from './splat-set.ts';

const unit = fc
  .tuple(...Array.from({ length: 4 }, () => fc.double({ min: -1, max: 1, noNaN: true })))
  .map((values) => ({ values, length: Math.hypot(...values) }))
  .filter(({ length }) => length > 0.1)
  .map(({ values, length }) => values.map((value) => value / length));

/** Column-major matrix of the unit quaternion w, x, y, z. */
const matrixOf = ([w, x, y, z]: readonly number[]) => [
  ...[1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)],
  ...[2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)],
  ...[2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)],
];

const coefficients = (degree: ShDegree) =>
  Float32Array.from({ length: coefficientsPerSplat(degree) }, (_, i) => Math.sin(7 * i + 1));

const colorAlong = (degree: ShDegree, values: Float32Array, [x, y, z]: readonly number[]) => {
  const basis = shRestBasis(degree, x, y, z);
  return [0, 1, 2].map((channel) =>
    basis.reduce((sum, value, k) => sum + value * values[3 * k + channel], 0),
  );
};

test.each([1, 2, 3] as const)(
  'degree %i: along a turned direction, the colour is as it was before',
  (degree) => {
    fc.assert(
      fc.property(unit, unit, fc.boolean(), (quaternion, [a, b, c], isMirrored) => {
        const length = Math.hypot(a, b, c);
        fc.pre(length > 0.1);
        const d = [a / length, b / length, c / length];
        const turn = matrixOf(quaternion).map((value) => (isMirrored ? -value : value));
        const turned = [0, 1, 2].map((r) => turn[r] * d[0] + turn[3 + r] * d[1] + turn[6 + r] * d[2]);
        const values = coefficients(degree);
        const expected = colorAlong(degree, values, d);
        new HarmonicsTurn(degree, turn).apply(values, 0);
        // Each of up to 15 coefficients of at most 3 is rounded to float32 once.
        colorAlong(degree, values, turned).forEach((value, channel) => {
          expect(Math.abs(value - expected[channel])).toBeLessThan(15 * 3 * 2 ** -24);
        });
      }),
      { numRuns: 50 },
    );
  },
);

test('no turn changes nothing but the last bits, and only the splat that is asked for', () => {
  const values = Float32Array.of(9, ...coefficients(3), 9);
  const before = values.slice();
  new HarmonicsTurn(3, [1, 0, 0, 0, 1, 0, 0, 0, 1]).apply(values, 1);
  values.forEach((value, i) => {
    expect(Math.abs(value - before[i])).toBeLessThanOrEqual(2 ** -23);
  });
  expect([values[0], values.at(-1)]).toEqual([9, 9]);
});
