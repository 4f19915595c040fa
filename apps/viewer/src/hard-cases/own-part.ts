import { BLACK, type Pixels, shownBytes, stepsBetween } from '../engine/shown-pixels.ts';
import type { SizePx } from './case-images.ts';

/** A part of a picture. */
export interface Box extends SizePx {
  readonly leftPx: number;
  readonly topPx: number;
}

/** Differences of a channel, in steps of 255: the least that counts, and one that has all its colour. */
const SEEN_STEPS = 3;
const COLOURED_STEPS = 16;
/** What is small is shown so many times larger at most. */
const MOST_MAGNIFIED = 5;
/** Around the part: this part of it on each side. */
const MARGIN = 0.25;
/** Of grey pixels beside colours. */
const DIMMED = 0.45;

/**
 * What of a case's picture is not in the ordinary one: the rest becomes grey, and `box`, as wide for
 * its height as the picture, surrounds what keeps its colours. It is all if nothing or most differs.
 *
 * @param own, ordinary premultiplied RGBA, 4·width·height values each, shown over black.
 */
export function ownPart(
  own: Pixels,
  ordinary: Pixels,
  { widthPx, heightPx }: SizePx,
): { readonly pixels: Uint8ClampedArray<ArrayBuffer>; readonly box: Box } {
  const pixels = shownBytes(own, BLACK);
  const steps = stepsBetween(own, ordinary, BLACK);
  let [left, top, right, bottom] = [widthPx, heightPx, 0, 0];
  for (let pixel = 0; pixel < widthPx * heightPx; pixel++) {
    const at = 4 * pixel;
    const color = pixels.subarray(at, at + 3);
    const grey = DIMMED * (0.21 * color[0] + 0.72 * color[1] + 0.07 * color[2]);
    const kept = Math.min(1, steps[pixel] / COLOURED_STEPS);
    color.set(color.map((channel) => grey + kept * (channel - grey)));
    if (steps[pixel] < SEEN_STEPS) continue;
    const [x, y] = [pixel % widthPx, Math.floor(pixel / widthPx)];
    [left, top] = [Math.min(left, x), Math.min(top, y)];
    [right, bottom] = [Math.max(right, x + 1), Math.max(bottom, y + 1)];
  }
  const part = Math.max((right - left) / widthPx, (bottom - top) / heightPx) * (1 + 2 * MARGIN);
  if (part <= 0 || part >= 1) return { pixels, box: { leftPx: 0, topPx: 0, widthPx, heightPx } };
  const shown = Math.max(part, 1 / MOST_MAGNIFIED);
  const within = (center: number, size: number) =>
    Math.min(size - shown * size, Math.max(0, center - (shown * size) / 2));
  const box = {
    leftPx: within((left + right) / 2, widthPx),
    topPx: within((top + bottom) / 2, heightPx),
    widthPx: shown * widthPx,
    heightPx: shown * heightPx,
  };
  return { pixels, box };
}
