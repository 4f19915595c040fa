import { describe, expect, test } from 'vitest';
import { Turns } from '../../data/turns.ts';
import { Choices, fuzz } from '../../testing/fuzz.ts';
import { encodeWebp } from '../formats/sog/write-sog.ts';
import { codeLengths } from './huffman-lengths.ts';
import { decodeVp8l, vp8lSize } from './vp8l.ts';
import { decodeWebp, openWebp } from './webp.ts';
import { encodeVp8l } from './write-vp8l.ts';

const choices = new Choices(5);
const encode = (width: number, height: number, rgba: Uint8Array) =>
  encodeVp8l(width, height, rgba, new Turns(undefined));

/** Encodes an image whose pixels are given by column and row, decodes it, and returns its bytes. */
async function bytesOf(width: number, height: number, pixelAt: (x: number, y: number) => readonly number[]) {
  const rgba = new Uint8Array(4 * width * height);
  for (let i = 0; i < width * height; i++) rgba.set(pixelAt(i % width, Math.floor(i / width)), 4 * i);
  const bytes = await encode(width, height, rgba);
  expect(vp8lSize(bytes)).toEqual({ width, height });
  // Not toEqual, which takes a second for some images.
  expect(Buffer.compare(decodeVp8l(bytes), rgba)).toBe(0);
  return bytes.length;
}

const noise = () => [choices.below(256), choices.below(256), choices.below(256), choices.below(256)];

describe('pixels come back', () => {
  test.each([
    [1, 1],
    [1, 40],
    [40, 1],
    [17, 33],
    [16, 16],
  ])('noise of %i x %i', async (width, height) => {
    // Each of the five codes takes some bytes; then no pixel more than it has.
    expect(await bytesOf(width, height, noise)).toBeLessThan(4 * width * height + 5 * 60 + 64);
  });

  test('one colour takes next to nothing', async () => {
    expect(await bytesOf(200, 100, () => [7, 250, 0, 255])).toBeLessThan(60);
    expect(await bytesOf(200, 100, () => [0, 0, 0, 0])).toBeLessThan(60);
  });

  test('two colours, in no order, come from a cache', async () => {
    const colors = [
      [1, 2, 3, 255],
      [200, 100, 0, 128],
    ];
    // The pixels that fill it have codes as well, so one of the two takes two bits.
    expect(await bytesOf(100, 100, () => choices.of(colors))).toBeLessThan((1.6 * 10_000) / 8);
  });

  test('slopes are predicted', async () => {
    expect(await bytesOf(100, 100, (x, y) => [x, 2 * y, x + y, 255])).toBeLessThan(300);
  });

  test('equal changes of all channels go with green', async () => {
    const greys = await bytesOf(64, 64, () => {
      const grey = choices.below(256);
      return [grey, grey, grey, 255];
    });
    expect(greys).toBeLessThan(1.05 * 64 * 64 + 300);
  });

  test('repeated pixels are copied', async () => {
    const tile = Array.from({ length: 256 }, noise);
    const size = await bytesOf(256, 64, (x, y) => tile[(x + 31 * y) % 256]);
    expect(size).toBeLessThan(4 * 256 + 5 * 200 + 400);
  });

  test('few colours fill a cache', async () => {
    const colors = Array.from({ length: 30 }, noise);
    expect(await bytesOf(100, 100, () => choices.of(colors))).toBeLessThan(
      (1.1 * 10_000 * Math.log2(30)) / 8,
    );
  });

  test('colours of which some are very rare, whose codes would be longer than 15 bits', async () => {
    // The Fibonacci numbers give the deepest tree.
    const shades: number[] = [];
    for (let i = 0, a = 1, b = 1; i < 20; i++, [a, b] = [b, a + b])
      for (let k = 0; k < a; k++) shades.push(11 * i);
    for (let i = shades.length - 1; i > 0; i--) {
      const other = choices.below(i + 1);
      [shades[i], shades[other]] = [shades[other], shades[i]];
    }
    expect(await bytesOf(100, 177, (x, y) => [0, shades[100 * y + x] ?? 0, 0, 255])).toBeLessThan(7000);
  });

  test('any image', { tags: 'deeper' }, async () => {
    await fuzz({ few: 40, many: 2500 }, async (picks) => {
      const [width, height] = [1 + picks.below(40), 1 + picks.below(40)];
      const range = picks.of([1, 2, 5, 60, 256]);
      const again = picks.of([0, 0.5, 0.95]);
      let pixel: number[] = [0, 0, 0, 0];
      await bytesOf(width, height, () => {
        if (!picks.isTrue(again)) pixel = pixel.map(() => picks.below(range));
        return pixel;
      });
    });
  });
});

test('a file has the image, and the same bytes each time', async () => {
  const rgba = Uint8Array.from({ length: 4 * 35 }, () => choices.below(256));
  const file = await encodeWebp(7, 5, rgba, new Turns(undefined));
  expect(decodeWebp(openWebp(file, 'a.webp'))).toEqual(rgba);
  expect(file.length % 2).toBe(0);
  expect(await encodeWebp(7, 5, rgba, new Turns(undefined))).toEqual(file);
});

test('an abort ends encoding', async () => {
  const turns = new Turns(AbortSignal.abort('enough'));
  await expect(encodeVp8l(8, 8, new Uint8Array(256), turns)).rejects.toBe('enough');
});

test('code lengths make a complete code, and no longer one than Huffman’s where that is short enough', () => {
  const counts = Uint32Array.from({ length: 60 }, (_, i) =>
    i % 7 === 0 ? 0 : 1 + choices.below(2 ** (i / 3)),
  );
  const bitsOf = (lengths: Uint8Array) => lengths.reduce((sum, length, i) => sum + length * counts[i], 0);
  const free = codeLengths(counts, 60);
  for (const most of [6, 7, 15]) {
    const lengths = codeLengths(counts, most);
    expect(Math.max(...lengths)).toBeLessThanOrEqual(most);
    expect(lengths.reduce((sum, length) => sum + (length > 0 ? 2 ** -length : 0), 0)).toBe(1);
    expect(lengths.map((length) => Math.min(1, length))).toEqual(
      Uint8Array.from(counts, (n) => Math.min(1, n)),
    );
    expect(bitsOf(lengths)).toBeGreaterThanOrEqual(bitsOf(free));
  }
  const total = counts.reduce((sum, count) => sum + count, 0);
  const entropy = counts.reduce(
    (sum, count) => (count > 0 ? sum + count * Math.log2(total / count) : sum),
    0,
  );
  expect(bitsOf(free)).toBeLessThan(entropy + total);
});
