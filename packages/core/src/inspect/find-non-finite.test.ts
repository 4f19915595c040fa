import { expect, test } from 'vitest';
import { describePixel, nonFiniteWord } from './find-non-finite.ts';

const bitsOf = (...values: number[]) => new Uint32Array(Float32Array.from(values).buffer);

test('finds NaN and infinities by their bits', () => {
  expect(nonFiniteWord(bitsOf(0, -0, 1e-45, -3.4e38, 3.4e38))).toBe(-1);
  for (const bad of [Number.NaN, Number.POSITIVE_INFINITY, Number.NEGATIVE_INFINITY])
    expect(nonFiniteWord(bitsOf(1, 2, bad, bad))).toBe(2);
  expect(nonFiniteWord(Uint32Array.of(0x7f800001))).toBe(0);
});

test('names a place in an image', () => {
  expect(describePixel(64, 4 * (64 * 3 + 5) + 2)).toBe('column 5, row 3, channel 2');
});
