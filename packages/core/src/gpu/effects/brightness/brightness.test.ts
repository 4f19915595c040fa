import { describe, expect, test } from 'vitest';
import { InvalidArgumentError } from '../../../data/errors.ts';
import type { SplatValues } from '../../../reference/effects/effect-reference.ts';
import { reference } from './brightness.reference.ts';
import { brightness } from './brightness.ts';

const SPLAT: SplatValues = {
  row: 0,
  position: [0, 0, 0],
  opacity: 1,
  rotation: [1, 0, 0, 0],
  logScales: [0, 0, 0],
};
const exposed = (factor: number, grey: number) =>
  reference(factor).changeColor!([grey, grey, grey], SPLAT, 0, [0, 0, -1])[0];

describe('brightness', () => {
  test('multiplies linear light: encoded 0.7354 is half as bright as white', () => {
    expect(exposed(2, 0.735357)).toBeCloseTo(1, 5);
    expect(exposed(0.5, 1)).toBeCloseTo(0.735357, 5);
    expect(exposed(7, 0)).toBe(0);
    expect(exposed(0, 0.6)).toBe(0);
    // Nothing beyond white is cut off, so darkening afterwards restores it.
    expect(exposed(0.25, exposed(4, 0.9))).toBeCloseTo(0.9, 12);
  });

  test('of 1 changes nothing and has no reason', () => {
    expect(brightness(1).reason).toBeNull();
    expect(brightness(1.5).reason).toContain('1.5');
  });

  for (const factor of [-0.1, Number.NaN, Number.POSITIVE_INFINITY, 2 ** 21])
    test(`of ${factor} is rejected`, () => {
      expect(() => brightness(factor)).toThrow(InvalidArgumentError);
    });
});
