import type { FrameRasterizer, RasterizerReport, StageTimings } from '@websplatter/core';
import type { ChosenCamera } from './choose-camera.ts';
import type { RawImage } from './images.ts';

/** Result of a renderer. */
export interface Rendered {
  readonly chosen: ChosenCamera;
  /** The last frame. */
  readonly image: RawImage;
  readonly visibleSplats: number;
  /** Of the detail that was found, against full detail; null if none was to be found. */
  readonly psnrDb: number | null;
  readonly splatsPerScene: readonly number[];
  /** Number of frames drawn beforehand, neither measured nor compared. */
  readonly warmUpFrames: number;
  /** One per measured frame. */
  readonly timings: readonly StageTimings[];
  /** The rasteriser of the measured frames; null for the reference renderer. */
  readonly rasterizer: DrawnBy | null;
  /** Name of the renderer: a GPU's label, or the reference renderer. */
  readonly label: string;
  /** Messages for the user, e.g. that no GPU was found. */
  readonly notices: readonly string[];
  /** The earliest frame that differs in a pixel from the first frame of its rasteriser; null if none does. */
  readonly firstDifference: { readonly frame: number; readonly pixels: number } | null;
}

/** The rasteriser of the frames, and facts about both rasterisers after them. */
export interface DrawnBy extends Omit<RasterizerReport, 'rasterizer'> {
  /** Number of measured frames by rasteriser. */
  readonly frames: Readonly<Record<FrameRasterizer, number>>;
}

/** Counts the pixels in which two images of one size differ in any bit. */
export function differingPixels(a: Float32Array | Float64Array, b: Float32Array | Float64Array): number {
  let pixels = 0;
  for (let i = 0; i < a.length; i += 4) {
    // Object.is, so that NaN equals NaN and 0 differs from −0.
    if (![0, 1, 2, 3].every((channel) => Object.is(a[i + channel], b[i + channel]))) pixels++;
  }
  return pixels;
}
