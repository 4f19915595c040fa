import fc from 'fast-check';
import { describe, expect, it } from 'vitest';
import { formatAt, roundAbove, roundedTo, stepFor } from './nice-steps.ts';

describe('the steps of a slider', () => {
  it.each([
    [1, 0.005],
    [2, 0.01],
    [3, 0.01],
    [8, 0.02],
    [2000, 10],
    [0.0005, 0.000002],
  ])('are nice over a length of %d', (length, step) => expect(stepFor(length)).toBe(step));

  it('are 200 to 500 for any length', () => {
    fc.assert(
      fc.property(fc.double({ min: 1e-12, max: 1e12, noNaN: true }), (length) => {
        const count = length / stepFor(length);
        expect(count).toBeGreaterThan(199.99);
        expect(count).toBeLessThan(500.01);
      }),
    );
  });

  it('round values to short decimals, and not to −0', () => {
    expect(roundedTo(0.30000000000000004, 0.005)).toBe(0.3);
    expect(roundedTo(1234.56, 10)).toBe(1230);
    expect(Object.is(roundedTo(-0.001, 0.01), 0)).toBe(true);
  });

  it('say how many digits are written', () => {
    expect(formatAt(-0.5, 0.005)).toBe('−0.500');
    expect(formatAt(-1e-17, 0.005)).toBe('0.000');
    expect(formatAt(20, 10)).toBe('20');
  });
});

describe('a round number above another', () => {
  it.each([
    [0, 0],
    [1, 1],
    [1.1, 2],
    [3, 5],
    [6, 10],
    [0.00031, 0.0005],
    [255, 500],
  ])('rounds %d up to %d', (value, round) => {
    expect(roundAbove(value)).toBe(round);
  });
});
