import type { Vec3 } from '@websplatter/core';
import jpeg from 'jpeg-js';
import { type RawImage, toRgb8 } from './png.ts';

/** 1 to 100. */
const QUALITY = 85;

/** Encodes `image` over `background` (0…1, in the space of the pixels). */
export function encodeJpeg(image: RawImage, background: Vec3): Uint8Array {
  const { widthPx: width, heightPx: height } = image;
  const rgb = toRgb8(image, background);
  const data = new Uint8Array(4 * width * height);
  for (let i = 0; i < width * height; i++) data.set(rgb.subarray(3 * i, 3 * i + 3), 4 * i);
  return jpeg.encode({ width, height, data }, QUALITY).data;
}
