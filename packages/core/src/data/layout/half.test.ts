import fc from 'fast-check';
import { describe, expect, test } from 'vitest';
import { fromHalfBits, HALF_MAX, toHalfBits } from './half.ts';

/** Value of binary16 bits by the format's definition: independent of the code under test. */
function halfValue(bits: number): number {
  const text = bits.toString(2).padStart(16, '0');
  const exponent = Number.parseInt(text.slice(1, 6), 2);
  const fraction = Number.parseInt(text.slice(6), 2);
  const sign = text[0] === '1' ? -1 : 1;
  if (exponent === 31) return fraction ? Number.NaN : sign * Number.POSITIVE_INFINITY;
  return exponent ? sign * (1024 + fraction) * 2 ** (exponent - 25) : sign * fraction * 2 ** -24;
}

const PATTERNS = Array.from({ length: 65_536 }, (_, bits) => bits);

/** All finite values without a sign, ascending: their index is their bits. */
const MAGNITUDES = Array.from({ length: 0x7c00 }, (_, bits) => halfValue(bits));

/** Bits of the nearest magnitude, ties to even, by search. */
function nearestMagnitude(value: number): number {
  let low = 0;
  let high = MAGNITUDES.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (MAGNITUDES[middle] <= value) low = middle;
    else high = middle - 1;
  }
  if (low === MAGNITUDES.length - 1) return low;
  const below = value - MAGNITUDES[low];
  const above = MAGNITUDES[low + 1] - value;
  if (below !== above) return below < above ? low : low + 1;
  return low % 2 === 0 ? low : low + 1;
}

describe('binary16', () => {
  test('all 65,536 bit patterns have the value that the format defines', () => {
    const wrong = PATTERNS.filter((bits) => !Object.is(fromHalfBits(bits), halfValue(bits)));
    expect(wrong).toEqual([]);
  });

  test('every finite pattern survives a round trip, both zeros included', () => {
    const finite = PATTERNS.filter((bits) => Number.isFinite(halfValue(bits)));
    expect(finite.filter((bits) => toHalfBits(halfValue(bits)) !== bits)).toEqual([]);
  });

  test('values between two neighbours round to the nearer, and to the even one in the middle', () => {
    const wrong: number[] = [];
    for (let bits = 0; bits < MAGNITUDES.length - 1; bits++) {
      const middle = (MAGNITUDES[bits] + MAGNITUDES[bits + 1]) / 2;
      const step = MAGNITUDES[bits + 1] - MAGNITUDES[bits];
      for (const [value, expected] of [
        [middle, bits % 2 === 0 ? bits : bits + 1],
        // A thousandth of a step is far above float32's own rounding.
        [middle - step / 1000, bits],
        [middle + step / 1000, bits + 1],
      ]) {
        if (toHalfBits(value) !== expected || toHalfBits(-value) !== (expected | 0x8000)) wrong.push(value);
      }
    }
    expect(wrong).toEqual([]);
  });

  test('any float32 rounds to the nearest finite value', () => {
    fc.assert(
      fc.property(fc.float({ noNaN: true, noDefaultInfinity: true }), (value) => {
        const sign = Object.is(value, -0) || value < 0 ? 0x8000 : 0;
        expect(toHalfBits(value)).toBe(sign | nearestMagnitude(Math.abs(value)));
      }),
      { numRuns: 2000 },
    );
  });

  test('values that are too large are clamped, never infinite', () => {
    for (const value of [HALF_MAX, 65_519, 65_520, 1e6, 3e38, Number.POSITIVE_INFINITY]) {
      expect(fromHalfBits(toHalfBits(value))).toBe(HALF_MAX);
      expect(fromHalfBits(toHalfBits(-value))).toBe(-HALF_MAX);
    }
  });
});
