import fc from 'fast-check';
import { expect, test } from 'vitest';
import { exp, log, sinCos } from './portable-math.ts';

function near(found: number, expected: number, error: number): void {
  expect(Math.abs(found - expected)).toBeLessThanOrEqual(error);
}

test('exp is that of Math', () => {
  fc.assert(
    fc.property(fc.double({ min: -700, max: 700, noNaN: true }), (x) =>
      near(exp(x), Math.exp(x), 1e-14 * Math.exp(x)),
    ),
  );
  expect([exp(0), exp(-1000), exp(1000)]).toEqual([1, 0, Number.POSITIVE_INFINITY]);
});

test('log is that of Math', () => {
  fc.assert(
    fc.property(fc.double({ min: 1e-300, max: 1e300, noNaN: true }), (x) =>
      near(log(x), Math.log(x), 1e-14 * Math.max(1, Math.abs(Math.log(x)))),
    ),
  );
  expect(log(1)).toBe(0);
});

test('sinCos is that of Math', () => {
  fc.assert(
    fc.property(fc.double({ min: -20, max: 20, noNaN: true }), (x) => {
      const [sin, cos] = sinCos(x);
      near(sin, Math.sin(x), 1e-13);
      near(cos, Math.cos(x), 1e-13);
    }),
  );
});

test('values are the same, bit for bit, on every machine', () => {
  const found = [exp(1.3), exp(-7.3), log(11), log(0.003), ...sinCos(2)];
  expect(found).toEqual([
    3.6692966676192444, 0.0006755387751938444, 2.3978952727983707, -5.809142990314028, 0.9092974268256817,
    -0.4161468365471424,
  ]);
});
