import type { SizePx } from '../data/accuracy/accuracy.ts';

/**
 * Reference of upscale: bilinear between the middles of pixels, constant beyond the outermost.
 *
 * @param values image of size `from`, top row first, with any number of values per pixel.
 * @returns image of size `to`, with as many values per pixel.
 */
export function upscale(values: ArrayLike<number>, from: SizePx, to: SizePx): Float64Array {
  const channels = values.length / (from.widthPx * from.heightPx);
  const upscaled = new Float64Array(channels * to.widthPx * to.heightPx);
  for (let row = 0; row < to.heightPx; row++) {
    const [top, bottom, down] = neighbors(row, to.heightPx, from.heightPx);
    for (let column = 0; column < to.widthPx; column++) {
      const [left, right, along] = neighbors(column, to.widthPx, from.widthPx);
      for (let channel = 0; channel < channels; channel++) {
        const at = (x: number, y: number) => values[channels * (y * from.widthPx + x) + channel];
        const above = at(left, top) * (1 - along) + at(right, top) * along;
        const below = at(left, bottom) * (1 - along) + at(right, bottom) * along;
        upscaled[channels * (row * to.widthPx + column) + channel] = above * (1 - down) + below * down;
      }
    }
  }
  return upscaled;
}

/**
 * Finds the two of `smallPx` pixels whose middles surround the middle of pixel `index` of `sizePx`,
 * and the second one's weight.
 */
function neighbors(
  index: number,
  sizePx: number,
  smallPx: number,
): [low: number, high: number, weight: number] {
  const place = Math.max(0, Math.min(smallPx - 1, ((index + 0.5) * smallPx) / sizePx - 0.5));
  const low = Math.floor(place);
  return [low, Math.min(low + 1, smallPx - 1), place - low];
}
