// Proves: any damage to a lossless WebP gives an image or a typed error.
import { describe, expect, test } from 'vitest';
import { Choices, fuzz } from '../../testing/fuzz.ts';
import {
  BitWriter,
  type CodedImage,
  flatCode,
  type Item,
  steepCode,
  vp8lBytes,
} from '../../testing/webp-fixture.ts';
import { decodeVp8l, Vp8lError } from './vp8l.ts';

const choices = new Choices(7);
const noise = (count: number) =>
  Array.from({ length: count }, () => Math.floor(choices.next() * 2 ** 32) >>> 0);

const channelsOf = (argb: number) => [(argb >>> 16) & 255, (argb >>> 8) & 255, argb & 255, argb >>> 24];
const rgbaOf = (pixels: readonly number[]) => Uint8Array.from(pixels.flatMap(channelsOf));
const argbOf = ([r, g, b, a]: readonly number[]) => ((a << 24) | (r << 16) | (g << 8) | b) >>> 0;
const each = (combine: (...values: number[]) => number, ...pixels: number[]) =>
  argbOf([0, 1, 2, 3].map((channel) => combine(...pixels.map((pixel) => channelsOf(pixel)[channel])) & 255));
const clamp = (value: number) => Math.min(255, Math.max(0, value));

describe('pixels', () => {
  test('literals, by flat codes and by codes of up to 15 bits', () => {
    const items = noise(35);
    expect(decodeVp8l(vp8lBytes(7, 5, { items }))).toEqual(rgbaOf(items));
    const steep = { green: steepCode(280), red: steepCode(256), blue: steepCode(256), alpha: steepCode(256) };
    expect(decodeVp8l(vp8lBytes(5, 7, { items, groups: [steep] }))).toEqual(rgbaOf(items));
  });

  test('codes with one symbol, which take no bits, and with two', () => {
    const groups = [
      { red: { symbols: [9] }, blue: { symbols: [200, 7] }, alpha: { symbols: [255] } },
    ] as const;
    const items = [0xff0910c8, 0xff090007, 0xff09ff07, 0xff0980c8];
    expect(decodeVp8l(vp8lBytes(2, 2, { items, groups }))).toEqual(rgbaOf(items));
  });

  test('copies, also over themselves, at far and at near distances', () => {
    const first = noise(24);
    const width = 10;
    const items: Item[] = [
      ...first,
      // One to the left, again and again.
      { length: 30, distanceCode: 2 },
      // The pixel above, then to the left of it, then 3 up and 2 to the right.
      { length: 3, distanceCode: 1 },
      { length: 2, distanceCode: 3 },
      { length: 1, distanceCode: 20 },
      // 50 pixels before.
      { length: 40, distanceCode: 170 },
    ];
    const pixels = [...first];
    const copy = (length: number, distance: number) => {
      for (let i = 0; i < length; i++) pixels.push(pixels[pixels.length - distance]);
    };
    copy(30, 1);
    copy(3, width);
    copy(2, width + 1);
    copy(1, 3 * width - 2);
    copy(40, 50);
    expect(decodeVp8l(vp8lBytes(width, 10, { items }))).toEqual(rgbaOf(pixels));
  });

  test('a colour cache, which copies fill as well', () => {
    const cacheBits = 3;
    const slotOf = (argb: number) => Math.imul(0x1e35a7bd, argb) >>> (32 - cacheBits);
    const [a, b, c] = [0xff102030, 0x01020304, 0x80ff00ff].sort((x, y) => slotOf(x) - slotOf(y));
    expect(new Set([a, b, c].map(slotOf)).size).toBe(3);
    const items: Item[] = [
      a,
      b,
      { cached: slotOf(a) },
      { length: 2, distanceCode: 2 + 120 },
      c,
      { cached: slotOf(b) },
      { cached: slotOf(c) },
      { cached: [0, 1, 2, 3].find((slot) => ![a, b, c].map(slotOf).includes(slot)) ?? 7 },
    ];
    const pixels = [a, b, a, b, a, c, b, c, 0];
    expect(decodeVp8l(vp8lBytes(3, 3, { items, cacheBits }))).toEqual(rgbaOf(pixels));
  });

  test('codes of its own for each block, also after copies into others', () => {
    const width = 9;
    const blocks = { bits: 2, width, groups: [0, 1, 2, 2, 0, 1] };
    const groups = [{}, { green: steepCode(280) }, { red: [...flatCode(250), 0, 0, 0, 0, 0, 0] }];
    const first = noise(40).map((pixel) => (pixel & 0xff00ffff) >>> 0);
    const items: Item[] = [...first, { length: 7, distanceCode: 121 + 8 }, ...first.slice(0, 25)];
    const pixels = [...first, ...first.slice(31, 38), ...first.slice(0, 25)];
    expect(decodeVp8l(vp8lBytes(width, 8, { items, groups, blocks }))).toEqual(rgbaOf(pixels));
  });
});

describe('transforms', () => {
  const width = 11;
  const height = 6;
  const coded = noise(width * height);
  const blockImage = (values: readonly number[]): CodedImage => ({ items: [...values] });

  /** Predicts as RFC 9649 says, channel by channel. */
  function predicted(mode: number, l: number, t: number, tl: number, tr: number): number {
    const mean = (a: number, b: number) => each((x, y) => (x + y) >> 1, a, b);
    const distance = (from: number, to: number) =>
      channelsOf(from).reduce((sum, value, channel) => sum + Math.abs(value - channelsOf(to)[channel]), 0);
    // From left + top − top left, the left is as far as the top from the top left.
    const predictions = [
      () => 0xff000000,
      () => l,
      () => t,
      () => tr,
      () => tl,
      () => mean(mean(l, tr), t),
      () => mean(l, tl),
      () => mean(l, t),
      () => mean(tl, t),
      () => mean(t, tr),
      () => mean(mean(l, tl), mean(t, tr)),
      () => (distance(t, tl) < distance(l, tl) ? l : t),
      () => each((x, y, z) => clamp(x + y - z), l, t, tl),
      () => each((x, y) => clamp(x + Math.trunc((x - y) / 2)), mean(l, t), tl),
    ];
    return (predictions[mode] ?? predictions[0])();
  }

  test.each(Array.from({ length: 16 }, (_, mode) => mode))('predictor %i', (mode) => {
    const pixels: number[] = [];
    coded.forEach((rest, i) => {
      const [x, y] = [i % width, Math.floor(i / width)];
      // The first block has the mode, the one to its right predicts black.
      const blockMode = x < 8 ? mode : 0;
      let prediction = predicted(
        blockMode,
        pixels[i - 1],
        pixels[i - width],
        pixels[i - width - 1],
        pixels[i - width + 1],
      );
      if (y === 0) prediction = x === 0 ? 0xff000000 : pixels[i - 1];
      else if (x === 0) prediction = pixels[i - width];
      pixels.push(each((a, b) => a + b, rest, prediction));
    });
    const image = blockImage([mode << 8, 0]);
    const bytes = vp8lBytes(width, height, { items: coded }, [{ type: 'predictor', bits: 3, image }]);
    expect(decodeVp8l(bytes)).toEqual(rgbaOf(pixels));
  });

  test('colours from other channels', () => {
    const factors = [0xff123456, 0xff80ff7f];
    const signed = (value: number) => (value << 24) >> 24;
    const pixels = coded.map((pixel, i) => {
      const factor = channelsOf(factors[i % width < 8 ? 0 : 1]);
      const [r, g, b, a] = channelsOf(pixel);
      const delta = (t: number, c: number) => (signed(t) * signed(c)) >> 5;
      const red = (r + delta(factor[2], g)) & 255;
      const blue = (b + delta(factor[1], g) + delta(factor[0], red)) & 255;
      return argbOf([red, g, blue, a]);
    });
    const image = blockImage(factors);
    const bytes = vp8lBytes(width, height, { items: coded }, [{ type: 'cross-color', bits: 3, image }]);
    expect(decodeVp8l(bytes)).toEqual(rgbaOf(pixels));
  });

  test('red and blue without green', () => {
    const pixels = coded.map((pixel) => {
      const [r, g, b, a] = channelsOf(pixel);
      return argbOf([(r + g) & 255, g, (b + g) & 255, a]);
    });
    const bytes = vp8lBytes(width, height, { items: coded }, [{ type: 'subtract-green' }]);
    expect(decodeVp8l(bytes)).toEqual(rgbaOf(pixels));
  });

  test.each([2, 3, 16, 17, 256])('a table of %i colours', (size) => {
    const colors = noise(size);
    const differences = colors.map((color, i) => each((a, b) => a - b, color, i > 0 ? colors[i - 1] : 0));
    const perPixel = size <= 2 ? 8 : size <= 4 ? 4 : size <= 16 ? 2 : 1;
    const bitsEach = 8 / perPixel;
    const indices = Array.from({ length: width * height }, () => choices.below(2 ** bitsEach));
    const items: number[] = [];
    for (let y = 0; y < height; y++) {
      for (let x = 0; x < width; x += perPixel) {
        const packed = indices.slice(y * width + x, y * width + Math.min(width, x + perPixel));
        items.push(packed.reduce((sum, index, i) => sum | (index << (i * bitsEach)), 0) << 8);
      }
    }
    const transforms = [{ type: 'color-indexing', size, image: { items: differences } }] as const;
    // Indices beyond the table are transparent black.
    const pixels = indices.map((index) => colors[index] ?? 0);
    expect(decodeVp8l(vp8lBytes(width, height, { items }, transforms))).toEqual(rgbaOf(pixels));
  });

  test('several, undone from the last to the first', () => {
    const image = blockImage([1 << 8, 1 << 8]);
    const bytes = vp8lBytes(width, height, { items: coded }, [
      { type: 'predictor', bits: 3, image },
      { type: 'subtract-green' },
    ]);
    const pixels: number[] = [];
    coded.forEach((pixel, i) => {
      const [r, g, b, a] = channelsOf(pixel);
      const rest = argbOf([(r + g) & 255, g, (b + g) & 255, a]);
      const before = i === 0 ? 0xff000000 : pixels[i % width === 0 ? i - width : i - 1];
      pixels.push(each((x, y) => x + y, rest, before));
    });
    expect(decodeVp8l(bytes)).toEqual(rgbaOf(pixels));
  });
});

describe('bytes that are no image', () => {
  const items = noise(4);
  const good = vp8lBytes(2, 2, { items });
  const failure = (bytes: Uint8Array) => {
    try {
      decodeVp8l(bytes);
    } catch (error) {
      expect(error).toBeInstanceOf(Vp8lError);
      return (error as Error).message;
    }
    return 'no error';
  };

  test('a wrong signature or version', () => {
    expect(failure(Uint8Array.of(0x2e, ...good.subarray(1)))).toBe('its signature is wrong');
    const version = Uint8Array.from(good);
    version[4] |= 0x60;
    expect(failure(version)).toBe('its version is 3, not 0');
  });

  test('truncated anywhere', () => {
    for (let length = 0; length < good.length; length++)
      expect(failure(good.subarray(0, length)), `${length} bytes`).toMatch(/ends/);
  });

  test('codes that are no prefix codes', () => {
    const withRed = (red: number[]) => failure(vp8lBytes(2, 2, { items: [], groups: [{ red }] }));
    const codes = (...lengths: number[]) => [...lengths, ...new Array(256 - lengths.length).fill(0)];
    expect(withRed(codes(1, 1, 1))).toBe('a prefix code has too many codes');
    expect(withRed(codes(1, 2))).toBe('a prefix code is incomplete');
    expect(withRed(codes())).toBe('a prefix code is incomplete');
    const distance = { symbols: [40] } as const;
    expect(failure(vp8lBytes(2, 2, { items, groups: [{ distance }] }))).toMatch(
      /symbol that its alphabet lacks/,
    );
  });

  test('copies from before the first pixel, and past the last', () => {
    const outside = 'it copies pixels from outside of it';
    expect(failure(vp8lBytes(2, 2, { items: [1, { length: 1, distanceCode: 122 }] }))).toBe(outside);
    expect(failure(vp8lBytes(2, 2, { items: [1, { length: 4, distanceCode: 121 }] }))).toBe(outside);
  });

  test('a transform twice, and a colour cache of too many bits', () => {
    const twice = vp8lBytes(2, 2, { items }, [{ type: 'subtract-green' }, { type: 'subtract-green' }]);
    expect(failure(twice)).toBe('it has a transform twice');
    const bits = new BitWriter();
    bits.write(0x2f, 8);
    bits.write(0, 32);
    bits.write(0, 1);
    bits.write(1, 1);
    bits.write(12, 4);
    expect(failure(bits.finish())).toBe('its colour cache has 12 bits');
  });

  test('a few bytes that ask for many tables', () => {
    // 65,536 groups, of which one is there.
    const blocks = { bits: 2, width: 16, groups: new Array(16).fill(0xffff) };
    expect(failure(vp8lBytes(16, 16, { items: [], groups: [{}], blocks }))).toMatch(/ends/);
  });

  test('any change gives pixels or a Vp8lError', { tags: 'deeper' }, async () => {
    const sources = [
      good,
      vp8lBytes(5, 5, { items: noise(25), cacheBits: 4, groups: [{ green: steepCode(296) }] }),
      vp8lBytes(8, 4, { items: noise(32) }, [
        { type: 'predictor', bits: 2, image: { items: [0x0b00, 0x0c00] } },
        { type: 'cross-color', bits: 2, image: { items: [1, 2] } },
      ]),
    ];
    await fuzz({ few: 300, many: 20_000 }, (picks) => {
      const bytes = Uint8Array.from(picks.of(sources));
      for (let i = picks.below(4); i >= 0; i--) bytes[picks.below(bytes.length)] = picks.below(256);
      // Not the size, which a caller bounds.
      bytes.set(good.subarray(0, 5));
      const rgba = failure(bytes.subarray(0, picks.isTrue(0.2) ? picks.below(bytes.length) : undefined));
      expect(rgba).toEqual(expect.any(String));
    });
  });
});
