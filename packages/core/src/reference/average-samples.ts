import type { SizePx } from '../data/accuracy/accuracy.ts';

/**
 * Reference of average-samples: each pixel of an image is the mean of a square of samples.
 *
 * @param samples RGBA, top row first, `perSide` times as many as pixels along each side.
 * @param size of the image.
 */
export function averageSamples(
  samples: ArrayLike<number>,
  { widthPx, heightPx }: SizePx,
  perSide: number,
): Float64Array {
  return Float64Array.from({ length: 4 * widthPx * heightPx }, (_, i) => {
    const [x, y] = [(i >> 2) % widthPx, Math.floor((i >> 2) / widthPx)];
    let sum = 0;
    for (let row = perSide * y; row < perSide * (y + 1); row++)
      for (let column = perSide * x; column < perSide * (x + 1); column++)
        sum += samples[4 * (row * perSide * widthPx + column) + (i & 3)];
    return sum / perSide ** 2;
  });
}
