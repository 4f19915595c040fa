import { decode } from 'fast-png';
import { expect, test } from 'vitest';
import { encodePng, encodeRaw, toRgb8 } from './images.ts';

test('pixels are composited over the background, rounded and clamped', () => {
  const data = Float32Array.of(0.2, 0, 0, 0.5, 0, 0, 0, 0, 1.5, -0.1, 0.5, 1);
  const raw = { widthPx: 3, heightPx: 1, data };
  expect([...toRgb8(raw, [1, 0.5, 0])]).toEqual([179, 64, 0, 255, 128, 0, 255, 0, 128]);
});

test('the PNG holds the composited image, opaque', () => {
  const raw = { widthPx: 2, heightPx: 2, data: Float32Array.from({ length: 16 }, (_, i) => i / 16) };
  const image = decode(encodePng(raw, [0, 0, 0]));
  expect([image.width, image.height, image.channels, image.depth]).toEqual([2, 2, 3, 8]);
  expect([...image.data]).toEqual([...toRgb8(raw, [0, 0, 0])]);
});

test('the raw file is little-endian float32', () => {
  const bytes = encodeRaw({ widthPx: 1, heightPx: 1, data: Float64Array.of(1, 0.5, 0.25, 2) });
  expect([...bytes.subarray(0, 4)]).toEqual([0, 0, 0x80, 0x3f]);
  expect(bytes.length).toBe(16);
});
