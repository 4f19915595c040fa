import { BLACK, type Pixels, shownBytes, stepsBetween } from '../engine/shown-pixels.ts';
import type { SizePx } from './case-images.ts';

/** A rectangle in a picture. */
export interface Box extends SizePx {
  readonly leftPx: number;
  readonly topPx: number;
}

/** Channel differences in 8-bit steps: the least that counts, and the least with full colour. */
const SEEN_STEPS = 3;
const COLOURED_STEPS = 16;
/** Largest magnification of a small part. */
const MOST_MAGNIFIED = 5;
/** Margin on each side, as a fraction of the part's size. */
const MARGIN = 0.25;
/** Brightness of grey pixels. */
const DIMMED = 0.45;

/**
 * Highlights where a case's picture differs from the ordinary one. Other pixels become grey. `box`
 * surrounds the coloured pixels, with the picture's aspect ratio. If nothing or almost everything
 * differs, `box` is the whole picture.
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
