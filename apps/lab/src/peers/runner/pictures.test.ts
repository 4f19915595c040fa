import { expect, test } from 'vitest';
import { psnrOf } from './pictures.ts';

const size = { widthPx: 2, heightPx: 1 };

function picture(...rgba: number[]) {
  return { camera: 'front', ...size, rgbaBase64: Buffer.from(rgba).toString('base64'), pngBase64: '' };
}

/** Grey and half transparent red, premultiplied. */
const reference = Float64Array.of(0.5, 0.5, 0.5, 1, 0.5, 0, 0, 0.5);

test('a picture that is right to its 8 bits has no error', () => {
  expect(psnrOf(picture(128, 128, 128, 255, 128, 0, 0, 255), reference)).toBe(Number.POSITIVE_INFINITY);
});

test('a picture that lacks a splat has one', () => {
  const psnrDb = psnrOf(picture(128, 128, 128, 255, 0, 0, 0, 255), reference);
  expect(psnrDb).toBeCloseTo(-10 * Math.log10((128 / 255) ** 2 / 6), 6);
});

test('a picture of another size is refused', () => {
  expect(() => psnrOf(picture(0, 0, 0, 255), reference)).toThrow(RangeError);
});
