import { ERROR_CLASSES } from '../accuracy/error-map.ts';
import { BLACK, type Pixels, stepsBetween } from '../engine/shown-pixels.ts';
import { roundAbove } from '../state/nice-steps.ts';

/** Colours from no difference to the largest, sRGB 0…255; lightness rises evenly. */
export const DIFFERENCE_COLORS = ERROR_CLASSES.map(({ color }) => color);

/** Difference of each pixel from the expected image, amplified to be visible. */
export interface Difference {
  readonly pixels: Uint8ClampedArray<ArrayBuffer>;
  /** Difference with the lightest colour, in 8-bit steps; a round number, 0 for equal images. */
  readonly fullSteps: number;
  /** Largest difference of any channel, in steps of an 8-bit channel. */
  readonly maxSteps: number;
}

/** Compares images on black: the largest channel difference of each pixel. */
export function differenceOf(actual: Pixels, expected: Pixels): Difference {
  const steps = stepsBetween(actual, expected, BLACK);
  const maxSteps = steps.reduce((most, each) => Math.max(most, each), 0);
  const fullSteps = roundAbove(maxSteps);
  const pixels = new Uint8ClampedArray(actual.length);
  for (const [pixel, each] of steps.entries()) {
    pixels.set(colorAt(fullSteps > 0 ? each / fullSteps : 0), 4 * pixel);
    pixels[4 * pixel + 3] = 255;
  }
  return { pixels, fullSteps, maxSteps };
}

/** @param part position on the colour scale, 0…1. */
function colorAt(part: number): number[] {
  const last = DIFFERENCE_COLORS.length - 1;
  const place = part * last;
  const index = Math.min(last - 1, Math.floor(place));
  const [from, to] = [DIFFERENCE_COLORS[index], DIFFERENCE_COLORS[index + 1]];
  return from.map((channel, i) => Math.round(channel + (place - index) * (to[i] - channel)));
}
