import { deflateSync } from 'node:zlib';
import { expect, it } from 'vitest';
import { decodePng } from './png.ts';

const [WIDTH, HEIGHT] = [5, 10];

/** A PNG whose rows take each filter in turn; without checksums, which are not read here. */
function encodePng(pixels: Uint8Array, colorType: number, bits = 8): Uint8Array {
  const header = Buffer.alloc(13);
  header.writeUInt32BE(WIDTH, 0);
  header.writeUInt32BE(HEIGHT, 4);
  header.set([bits, colorType], 8);
  const compressed = deflateSync(filtered(pixels));
  // Browsers write several of them.
  const chunks = [
    ['IHDR', header],
    ['IDAT', compressed.subarray(0, 20)],
    ['IDAT', compressed.subarray(20)],
    ['IEND', Buffer.alloc(0)],
  ] as const;
  const parts = chunks.flatMap(([type, contents]) => {
    const length = Buffer.alloc(4);
    length.writeUInt32BE(contents.length);
    return [length, Buffer.from(type), contents, Buffer.alloc(4)];
  });
  return Buffer.concat([Buffer.alloc(8), ...parts]);
}

function filtered(pixels: Uint8Array): Uint8Array {
  const rowBytes = pixels.length / HEIGHT;
  const channels = rowBytes / WIDTH;
  const at = (x: number, y: number) => (x < 0 || y < 0 ? 0 : pixels[y * rowBytes + x]);
  const paeth = (left: number, up: number, upLeft: number) => {
    const estimate = left + up - upLeft;
    // The first of those that are equally near.
    return [left, up, upLeft].toSorted((a, b) => Math.abs(a - estimate) - Math.abs(b - estimate))[0];
  };
  const rows = Array.from({ length: HEIGHT }, (_, y) => [
    y % 5,
    ...Array.from({ length: rowBytes }, (_, x) => {
      const [left, up, upLeft] = [at(x - channels, y), at(x, y - 1), at(x - channels, y - 1)];
      return at(x, y) - [0, left, up, Math.floor((left + up) / 2), paeth(left, up, upLeft)][y % 5];
    }),
  ]);
  return Uint8Array.from(rows.flat());
}

it.each([
  ['RGB', 2, 3],
  ['RGBA', 6, 4],
])('PNGs of %s are decoded, whichever filters their rows take', (_, colorType, channels) => {
  const pixels = Uint8Array.from({ length: channels * WIDTH * HEIGHT }, (_, i) => (i * i * 37) % 251);
  const { widthPx, heightPx, data } = decodePng(encodePng(pixels, colorType));
  expect([widthPx, heightPx]).toEqual([WIDTH, HEIGHT]);
  for (let pixel = 0; pixel < WIDTH * HEIGHT; pixel++) {
    const color = [...pixels.subarray(channels * pixel, channels * (pixel + 1)), 255].slice(0, 4);
    expect([...data.subarray(4 * pixel, 4 * pixel + 4)]).toEqual(color);
  }
});

it('PNGs of other kinds, and other files, are refused', () => {
  expect(() => decodePng(encodePng(new Uint8Array(WIDTH * HEIGHT), 0))).toThrow('colour type 0');
  expect(() => decodePng(encodePng(new Uint8Array(6 * WIDTH * HEIGHT), 2, 16))).toThrow('16 bits');
  expect(() => decodePng(new Uint8Array(40))).toThrow('no PNG');
});
