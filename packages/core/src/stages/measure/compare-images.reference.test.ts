import { describe, expect, test } from 'vitest';
import { seededRandom } from '../../testing/seeded-random.ts';
import { compareImages } from './measure.reference.ts';

const [widthPx, heightPx] = [40, 30];
const SIZE = { widthPx, heightPx };

/** Premultiplied RGBA by pixel. */
function image(at: (x: number, y: number) => readonly number[]): Float64Array {
  const data = new Float64Array(4 * widthPx * heightPx);
  for (let i = 0; i < widthPx * heightPx; i++) data.set(at(i % widthPx, Math.floor(i / widthPx)), 4 * i);
  return data;
}

const flat = (value: number) => image(() => [value, value, value, 1]);
const stripes = (shiftPx: number) =>
  image((x, y) => [0.5 + 0.4 * Math.sin((x + shiftPx) / 2), 0.5 + 0.4 * Math.sin(y / 4), 0.3, 1]);
const noise = (seed: number) => {
  const random = seededRandom(seed);
  return image(() => [random(), random(), random(), 1]);
};

describe('compareImages', () => {
  test('equal images', () => {
    expect(compareImages(noise(1), noise(1), SIZE)).toEqual({
      psnrDb: Number.POSITIVE_INFINITY,
      maxError: 0,
      p999Error: 0,
      ssim: expect.closeTo(1, 12),
    });
  });

  test('a constant difference has the PSNR of its square', () => {
    for (const [difference, psnrDb] of [
      [0.1, 20],
      [0.01, 40],
      [0.001, 60],
    ]) {
      const found = compareImages(flat(0.5 + difference), flat(0.5), SIZE);
      expect(found.psnrDb).toBeCloseTo(psnrDb, 6);
      expect(found.maxError).toBeCloseTo(difference, 9);
      expect(found.p999Error).toBeCloseTo(difference, 9);
    }
    expect(compareImages(flat(0), flat(1), SIZE).psnrDb).toBeCloseTo(0, 9);
  });

  test('one wrong channel of one pixel', () => {
    const wrong = flat(0.5);
    wrong[4 * 123 + 1] = 1;
    const { psnrDb, maxError, p999Error } = compareImages(wrong, flat(0.5), SIZE);
    expect(psnrDb).toBeCloseTo(-10 * Math.log10(0.25 / (3 * widthPx * heightPx)), 9);
    expect(maxError).toBe(0.5);
    // Fewer than one value in a thousand differ.
    expect(p999Error).toBe(0);
  });

  test('another image, or the same one shifted by a pixel, upside down or with swapped channels, is far off', () => {
    const original = stripes(0);
    const upsideDown = image((x, y) =>
      Array.from(original.slice(4 * ((heightPx - 1 - y) * widthPx + x)).slice(0, 4)),
    );
    const swapped = image((x, y) => {
      const [r, g, b, a] = original.slice(4 * (y * widthPx + x));
      return [b, g, r, a];
    });
    for (const wrong of [noise(2), stripes(1), upsideDown, swapped, flat(0)]) {
      const { psnrDb, ssim, maxError } = compareImages(wrong, original, SIZE);
      expect(psnrDb).toBeLessThan(25);
      expect(ssim).toBeLessThan(0.95);
      expect(maxError).toBeGreaterThan(0.1);
    }
  });

  test('a non-finite value is an error instead of a distance', () => {
    for (const value of [Number.NaN, Number.POSITIVE_INFINITY, Number.NEGATIVE_INFINITY]) {
      const broken = flat(0.5);
      broken[4 * 77 + 2] = value;
      expect(() => compareImages(broken, flat(0.5), SIZE)).toThrow(/actual is .* at pixel 77, channel 2/);
      expect(() => compareImages(flat(0.5), broken, SIZE)).toThrow(/expected is .* at pixel 77/);
    }
    const broken = flat(0.5);
    broken[4 * 5 + 3] = Number.NaN;
    expect(() => compareImages(broken, flat(0.5), SIZE)).toThrow(RangeError);
  });

  test('refuses images of another size', () => {
    expect(() => compareImages(flat(0).subarray(4), flat(0), SIZE)).toThrow(RangeError);
  });

  test('composites values over the background and clamps them first', () => {
    const glass = image(() => [0.25, 0, 0.1, 0.5]);
    const over = image(() => [0.25 + 0.5, 0.5, 0.1 + 0.25, 1]);
    const background = [1, 1, 0.5] as const;
    expect(compareImages(glass, over, { ...SIZE, background }).maxError).toBeCloseTo(0, 12);
    expect(compareImages(glass, over, SIZE).maxError).toBeCloseTo(0.5, 12);
    expect(compareImages(flat(7), flat(1), SIZE).maxError).toBe(0);
    expect(compareImages(flat(-7), flat(0), SIZE).maxError).toBe(0);
  });

  test('`png` rounds both to 8 bits', () => {
    const quantize = 'png' as const;
    expect(compareImages(flat(0.5), flat(0.5001), { ...SIZE, quantize }).maxError).toBe(0);
    expect(compareImages(flat(100 / 255), flat(101.4 / 255), { ...SIZE, quantize }).maxError).toBeCloseTo(
      1 / 255,
      12,
    );
  });

  test('SSIM falls with noise, even if the mean stays the same', () => {
    const [a, b] = [noise(3), noise(4)];
    const noisy = (amount: number) =>
      stripes(0).map((v, i) => (i % 4 === 3 ? v : v + amount * (a[i] - b[i])));
    const at = (amount: number) => compareImages(noisy(amount), stripes(0), SIZE).ssim;
    expect(at(0.01)).toBeGreaterThan(0.99);
    expect(at(0.1)).toBeLessThan(at(0.03));
    expect(at(0.1)).toBeGreaterThan(0);
    // An image and its negative.
    const negative = noise(5).map((v, i) => (i % 4 === 3 ? 1 : 1 - v));
    expect(compareImages(negative, noise(5), SIZE).ssim).toBeLessThan(-0.5);
  });
});
