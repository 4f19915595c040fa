import fc from 'fast-check';
import { expect, test } from 'vitest';
import { floatAbove, floatBelow, floatStep } from './float-step.ts';

test.each([
  [1, 2 ** -23],
  [-1.99, 2 ** -23],
  [2, 2 ** -22],
  [5_300_000.5, 0.5],
  [2 ** 40 - 1, 2 ** 16],
  [0, 2 ** -149],
  [2 ** -140, 2 ** -149],
])('neighbours of %d are %d apart', (value, step) => {
  expect(floatStep(value)).toBe(step);
});

test('any number lies between the float32 below and the one above, a step apart or none', () => {
  fc.assert(
    fc.property(fc.double({ min: -1e38, max: 1e38, noNaN: true }), (value) => {
      const [below, above] = [floatBelow(value), floatAbove(value)];
      expect([Math.fround(below), Math.fround(above)]).toEqual([below, above]);
      expect(below <= value && value <= above).toBe(true);
      expect(above - below).toBe(Math.fround(value) === value ? 0 : floatStep(value));
    }),
  );
});
