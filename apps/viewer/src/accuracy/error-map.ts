import { classOf, ERROR_CLASSES } from '@websplatter/kit/error-classes';
import { shownBytes, stepsBetween } from '@websplatter/kit/shown-pixels';
import type { ImageOnBackground } from '../engine/viewer.ts';
import type { ErrorFigures } from '../state/accuracy.ts';
import type { LayerImage } from '../state/frames.ts';
import type { JudgedPicture } from '../state/measured.ts';

/** An image of errors, with its statistics. */
export interface ErrorMap extends LayerImage {
  readonly figures: ErrorFigures;
}

/**
 * Classifies each pixel by its largest channel difference. Both images must have the same size; the
 * first one's background is used for both.
 */
export function errorMap(
  { image: actual, background }: ImageOnBackground,
  { image: reference }: ImageOnBackground,
): ErrorMap {
  const { widthPx, heightPx } = actual;
  const steps = stepsBetween(actual.data, reference.data, background);
  const counts = ERROR_CLASSES.map(() => 0);
  for (const each of steps) counts[classOf(each)]++;
  const maxSteps = steps.reduce((most, each) => Math.max(most, each), 0);
  const pixels = Math.max(1, widthPx * heightPx);
  const figures = { maxSteps, parts: counts.map((count) => count / pixels) };
  return { widthPx, heightPx, data: errorColors(steps), figures };
}

/** Colours of the pixels by their class, RGBA. */
function errorColors(steps: Float64Array): Uint8ClampedArray<ArrayBuffer> {
  const data = new Uint8ClampedArray(4 * steps.length);
  for (const [pixel, each] of steps.entries()) {
    data.set(ERROR_CLASSES[classOf(each)].color, 4 * pixel);
    data[4 * pixel + 3] = 255;
  }
  return data;
}

/** Side of a crop, px. */
export const CROP_PX = 64;
/** Crops begin at multiples of this, px. */
const GRID_PX = 8;

/** Compares two images of the same size on the first one's background. */
export function judgePicture(
  { image: actual, background }: ImageOnBackground,
  { image: reference }: ImageOnBackground,
): JudgedPicture {
  const { widthPx, heightPx } = actual;
  const steps = stepsBetween(actual.data, reference.data, background);
  const place = worstPlace(steps, widthPx, heightPx);
  const layer = (data: Uint8ClampedArray<ArrayBuffer>) => ({ widthPx, heightPx, data });
  // Rounded, as displays show them.
  const beyond = (most: number) =>
    steps.filter((each) => Math.round(each) > most).length / Math.max(1, steps.length);
  const whole = layer(shownBytes(actual.data, background));
  return {
    whole,
    ...place,
    beyond1: beyond(1),
    beyond8: beyond(8),
    actual: cropped(whole, place),
    reference: cropped(layer(shownBytes(reference.data, background)), place),
    error: cropped(layer(errorColors(steps)), place),
  };
}

/** Position of the first crop with the largest sum of squared errors. */
export function worstPlace(
  steps: ArrayLike<number>,
  widthPx: number,
  heightPx: number,
): { readonly xPx: number; readonly yPx: number } {
  const columns = Math.ceil(widthPx / GRID_PX);
  const rows = Math.ceil(heightPx / GRID_PX);
  /** Summed-area table over the grid. */
  const sums = new Float64Array((columns + 1) * (rows + 1));
  const sumAt = (column: number, row: number) => sums[row * (columns + 1) + column];
  for (let row = 0; row < rows; row++)
    for (let column = 0; column < columns; column++) {
      let sum = sumAt(column, row + 1) + sumAt(column + 1, row) - sumAt(column, row);
      for (let y = GRID_PX * row; y < Math.min(heightPx, GRID_PX * (row + 1)); y++)
        for (let x = GRID_PX * column; x < Math.min(widthPx, GRID_PX * (column + 1)); x++)
          sum += steps[y * widthPx + x] ** 2;
      sums[(row + 1) * (columns + 1) + column + 1] = sum;
    }
  const side = CROP_PX / GRID_PX;
  let worst = { xPx: 0, yPx: 0, sum: 0 };
  for (let row = 0; row <= Math.max(0, rows - side); row++)
    for (let column = 0; column <= Math.max(0, columns - side); column++) {
      const [right, bottom] = [Math.min(columns, column + side), Math.min(rows, row + side)];
      const sum = sumAt(right, bottom) - sumAt(column, bottom) - sumAt(right, row) + sumAt(column, row);
      if (sum > worst.sum) worst = { xPx: GRID_PX * column, yPx: GRID_PX * row, sum };
    }
  const within = (startPx: number, sizePx: number) => Math.max(0, Math.min(startPx, sizePx - CROP_PX));
  return { xPx: within(worst.xPx, widthPx), yPx: within(worst.yPx, heightPx) };
}

/** Copies the crop at a position; a smaller image is copied whole. */
function cropped(image: LayerImage, { xPx, yPx }: { xPx: number; yPx: number }): LayerImage {
  const widthPx = Math.min(CROP_PX, image.widthPx);
  const heightPx = Math.min(CROP_PX, image.heightPx);
  const data = new Uint8ClampedArray(4 * widthPx * heightPx);
  for (let y = 0; y < heightPx; y++) {
    const first = 4 * ((yPx + y) * image.widthPx + xPx);
    data.set(image.data.subarray(first, first + 4 * widthPx), 4 * y * widthPx);
  }
  return { widthPx, heightPx, data };
}
