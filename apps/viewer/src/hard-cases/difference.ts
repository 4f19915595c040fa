import type { SizePx } from './case-images.ts';

/** Colours from no difference to the largest, sRGB 0…255; lightness rises evenly. */
export const DIFFERENCE_COLORS = [
  [10, 8, 24],
  [62, 26, 122],
  [142, 40, 130],
  [222, 73, 98],
  [252, 151, 96],
  [252, 246, 184],
] as const;

/** How far an image is from the expected one, pixel by pixel, amplified so that it can be seen. */
export interface Difference {
  readonly pixels: Uint8ClampedArray<ArrayBuffer>;
  /** Difference of the lightest colour, in 8-bit steps; a round number, 0 for equal images. */
  readonly fullSteps: number;
  /** Largest difference of any channel, in steps of an 8-bit channel. */
  readonly maxSteps: number;
}

/**
 * Takes the largest difference of the channels of each pixel, over black.
 *
 * @param actual, expected premultiplied RGBA, 4·width·height values each.
 */
export function differenceOf(
  actual: ArrayLike<number>,
  expected: ArrayLike<number>,
  size: SizePx,
): Difference {
  const count = size.widthPx * size.heightPx;
  const steps = Float64Array.from({ length: count }, (_, pixel) => pixelSteps(actual, expected, 4 * pixel));
  const maxSteps = steps.reduce((most, each) => Math.max(most, each), 0);
  const fullSteps = roundAbove(maxSteps);
  const pixels = new Uint8ClampedArray(4 * count);
  for (const [pixel, each] of steps.entries()) {
    pixels.set(colorAt(fullSteps > 0 ? each / fullSteps : 0), 4 * pixel);
    pixels[4 * pixel + 3] = 255;
  }
  return { pixels, fullSteps, maxSteps };
}

/** Largest difference of the channels of the pixel whose values begin at `at`, in 8-bit steps. */
export function pixelSteps(actual: ArrayLike<number>, expected: ArrayLike<number>, at: number): number {
  let most = 0;
  for (let channel = at; channel < at + 3; channel++)
    most = Math.max(most, Math.abs(clamped(actual[channel]) - clamped(expected[channel])));
  return 255 * most;
}

/** Values as 8-bit RGBA on black. */
export function pixelsOnBlack(data: ArrayLike<number>): Uint8ClampedArray<ArrayBuffer> {
  return Uint8ClampedArray.from({ length: data.length }, (_, i) =>
    i % 4 === 3 ? 255 : Math.round(255 * clamped(data[i])),
  );
}

function clamped(value: number): number {
  return Math.min(1, Math.max(0, value));
}

/** The smallest of 1, 2, 5, 10, 20, … and their tenths that is not below `value`; 0 for 0. */
export function roundAbove(value: number): number {
  if (value <= 0) return 0;
  const power = 10 ** Math.floor(Math.log10(value));
  const factor = [1, 2, 5].find((each) => each * power >= value) ?? 10;
  return Number((factor * power).toPrecision(1));
}

/** @param part 0…1. */
function colorAt(part: number): number[] {
  const last = DIFFERENCE_COLORS.length - 1;
  const place = part * last;
  const index = Math.min(last - 1, Math.floor(place));
  const [from, to] = [DIFFERENCE_COLORS[index], DIFFERENCE_COLORS[index + 1]];
  return from.map((channel, i) => Math.round(channel + (place - index) * (to[i] - channel)));
}
