import type { Vec3 } from '@websplatter/core';
import { encode } from 'fast-png';
import jpeg from 'jpeg-js';

/** An image as rendered: premultiplied RGBA in the blending (sRGB-encoded) space, top row first. */
export interface RawImage {
  readonly widthPx: number;
  readonly heightPx: number;
  readonly data: Float32Array | Float64Array;
}

/** Composites `image` over `background` (0…1, in the space of the pixels) into opaque 8-bit RGB. */
export function toRgb8(image: RawImage, background: Vec3): Uint8Array {
  const { data } = image;
  const rgb = new Uint8Array((data.length / 4) * 3);
  for (let from = 0, to = 0; from < data.length; from += 4, to += 3) {
    const transmittance = 1 - data[from + 3];
    for (let channel = 0; channel < 3; channel++) {
      const value = data[from + channel] + transmittance * background[channel];
      rgb[to + channel] = Math.round(Math.min(1, Math.max(0, value)) * 255);
    }
  }
  return rgb;
}

export function encodePng(image: RawImage, background: Vec3): Uint8Array {
  const { widthPx: width, heightPx: height } = image;
  return encode({ width, height, data: toRgb8(image, background), channels: 3, depth: 8 });
}

/** Encodes `image` as W×H×4 float32, little-endian, top row first. */
export function encodeRaw(image: RawImage): Uint8Array {
  const bytes = new Uint8Array(image.data.length * 4);
  const view = new DataView(bytes.buffer);
  for (let i = 0; i < image.data.length; i++) view.setFloat32(i * 4, image.data[i], true);
  return bytes;
}

/** From 1 to 100. */
const JPEG_QUALITY = 85;

export function encodeJpeg(image: RawImage, background: Vec3): Uint8Array {
  const { widthPx: width, heightPx: height } = image;
  const rgb = toRgb8(image, background);
  const data = new Uint8Array(4 * width * height);
  for (let i = 0; i < width * height; i++) data.set(rgb.subarray(3 * i, 3 * i + 3), 4 * i);
  return jpeg.encode({ width, height, data }, JPEG_QUALITY).data;
}
