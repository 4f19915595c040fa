import type { StageTimings } from '@websplatter/core';
import type { Picture } from './png.ts';

/** What a renderer hands back. */
export interface Rendered {
  /** The last frame. */
  readonly picture: Picture;
  readonly visibleSplats: number;
  readonly splatsPerScene: readonly number[];
  /** Frames drawn beforehand, neither measured nor compared. */
  readonly warmUpFrames: number;
  /** One per frame that was measured. */
  readonly timings: readonly StageTimings[];
  /** What drew: a GPU's label, or the reference renderer. */
  readonly label: string;
  /** What the user should know, e.g. that no GPU was found. */
  readonly notices: readonly string[];
  /** First frame, from 1, that is not bit for bit like the first, and in how many pixels; null where all are alike. */
  readonly firstDifference: { readonly frame: number; readonly pixels: number } | null;
}

/** Number of pixels in which two pictures of one size differ in any bit. */
export function differingPixels(a: Float32Array | Float64Array, b: Float32Array | Float64Array): number {
  let pixels = 0;
  for (let i = 0; i < a.length; i += 4) {
    // Object.is: NaN is like NaN, and 0 is unlike −0.
    if (![0, 1, 2, 3].every((channel) => Object.is(a[i + channel], b[i + channel]))) pixels++;
  }
  return pixels;
}
