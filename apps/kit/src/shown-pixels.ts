import type { Vec3 } from '@websplatter/core';

/** Premultiplied RGBA, 0…1, as read back from views. */
export type Pixels = ArrayLike<number>;

export const BLACK: Vec3 = [0, 0, 0];

/** An image over a background (sRGB, 0…1), as the screen shows it: opaque RGBA bytes. */
export function shownBytes(pixels: Pixels, background: Vec3): Uint8ClampedArray<ArrayBuffer> {
  const bytes = new Uint8ClampedArray(pixels.length);
  for (let at = 0; at < pixels.length; at += 4) {
    for (let channel = 0; channel < 3; channel++)
      bytes[at + channel] = 255 * shownChannel(pixels, at, channel, background);
    bytes[at + 3] = 255;
  }
  return bytes;
}

/** The largest channel difference of each pixel on the screen, in steps of an 8-bit channel. */
export function stepsBetween(actual: Pixels, reference: Pixels, background: Vec3): Float64Array {
  const steps = new Float64Array(actual.length / 4);
  for (let pixel = 0; pixel < steps.length; pixel++)
    for (let channel = 0; channel < 3; channel++) {
      const difference =
        shownChannel(actual, 4 * pixel, channel, background) -
        shownChannel(reference, 4 * pixel, channel, background);
      steps[pixel] = Math.max(steps[pixel], 255 * Math.abs(difference));
    }
  return steps;
}

/** A channel of the pixel at index `at` on the screen, 0…1. */
function shownChannel(pixels: Pixels, at: number, channel: number, background: Vec3): number {
  return Math.min(1, Math.max(0, pixels[at + channel] + (1 - pixels[at + 3]) * background[channel]));
}
