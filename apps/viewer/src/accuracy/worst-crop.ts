import type { ImageOnBackground } from '../engine/drawn-frame.ts';
import { shownBytes, stepsBetween } from '../engine/shown-pixels.ts';
import type { LayerImage } from '../state/frames.ts';
import type { JudgedPicture } from '../state/measured.ts';
import { errorColors } from './error-map.ts';

/** Side of a crop. */
export const CROP_PX = 64;
/** Crops begin at multiples of this. */
const GRID_PX = 8;

/** Compares two images of the same size, on the background of the first. */
export function judgePicture(
  { image: actual, background }: ImageOnBackground,
  { image: reference }: ImageOnBackground,
): JudgedPicture {
  const { widthPx, heightPx } = actual;
  const steps = stepsBetween(actual.data, reference.data, background);
  const place = worstPlace(steps, widthPx, heightPx);
  const layer = (data: Uint8ClampedArray<ArrayBuffer>) => ({ widthPx, heightPx, data });
  const whole = layer(shownBytes(actual.data, background));
  return {
    whole,
    ...place,
    actual: cropped(whole, place),
    reference: cropped(layer(shownBytes(reference.data, background)), place),
    error: cropped(layer(errorColors(steps)), place),
  };
}

/** Where the squares of the errors in a crop have the largest sum; the first such place. */
export function worstPlace(
  steps: ArrayLike<number>,
  widthPx: number,
  heightPx: number,
): { readonly xPx: number; readonly yPx: number } {
  const columns = Math.ceil(widthPx / GRID_PX);
  const rows = Math.ceil(heightPx / GRID_PX);
  /** Sums over all that is above and left of a corner of the grid. */
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

/** A copy of the crop at a place, or of all of a smaller image. */
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
