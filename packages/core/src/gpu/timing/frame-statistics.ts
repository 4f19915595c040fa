import type { FrameRasterizer } from '../../data/accuracy/accuracy.ts';
import { given } from '../../data/given.ts';

/** Timed passes of a frame, in the order in which they run; none runs all of them. */
export const TIMED_PASSES = [
  'preprocess',
  'sort',
  'tile-lists',
  'resolve-depth',
  'quads-sample',
  'tiles',
  'rasterize',
  'upscale',
  'composite',
] as const;
/** Name of a pass of a frame that has timestamps of its own. */
export type TimedPass = (typeof TIMED_PASSES)[number];

/** Times of one frame, in milliseconds. */
export interface StageTimings {
  /**
   * `gpu-timestamps`: measured by the GPU at the ends of its passes. `wall-clock`: this device has
   * no timestamps, so only `totalMs` is known, from submission to completion, and the stages are
   * NaN.
   */
  readonly source: 'gpu-timestamps' | 'wall-clock';
  /** Culling, projection and colours; 0, like `sortMs`, if an embedded view kept its last order. */
  readonly preprocessMs: number;
  readonly sortMs: number;
  /**
   * Drawing the splats and blending them over the background or the host's image. Includes building
   * tile lists if tiles draw; excludes a sample of quads (`quadsSampleMs`).
   */
  readonly rasterizeMs: number;
  /** From the first pass to the last; with the host's work in between, if embedded. */
  readonly totalMs: number;
  /**
   * From submission to completion by the CPU's clock: includes waiting for earlier frames and for
   * the browser.
   */
  readonly wallClockMs: number;
  /**
   * Each pass that the frame ran; empty without timestamps. Tiles run as `tile-lists` and `tiles`,
   * quads as `rasterize`.
   */
  readonly passMs: Readonly<Partial<Record<TimedPass, number>>>;
}

/**
 * Timings without timestamps: only the total is known, by the wall clock.
 *
 * @hidden Shared with the packages beside this one.
 */
export function wallClockTimings(wallClockMs: number): StageTimings {
  const unknown = Number.NaN;
  return {
    source: 'wall-clock',
    preprocessMs: unknown,
    sortMs: unknown,
    rasterizeMs: unknown,
    totalMs: wallClockMs,
    wallClockMs,
    passMs: {},
  };
}

/** Timestamps and wall clock that differ by more than both of these describe different work. */
const PLAUSIBLE_FACTOR = 3;
const PLAUSIBLE_DIFFERENCE_MS = 20;

/**
 * Whether GPU timestamps fit the wall clock. Some browsers report a hundredth of the true time; a
 * few milliseconds more on the wall clock are the browser's own.
 *
 * @hidden Shared with the packages beside this one.
 */
export function isPlausible(timings: StageTimings): boolean {
  const { totalMs, wallClockMs } = given(
    timings,
    { totalMs: 'a number', wallClockMs: 'a number' },
    'timings',
  );
  const ratio = Math.max(totalMs, wallClockMs) / Math.min(totalMs, wallClockMs);
  return ratio <= PLAUSIBLE_FACTOR || Math.abs(totalMs - wallClockMs) <= PLAUSIBLE_DIFFERENCE_MS;
}

/** Statistics of one frame, available some frames after it was drawn. */
export interface FrameStatistics {
  /** Number of the frame, from 1. */
  readonly frame: number;
  readonly loadedSplats: number;
  /** Splats in the chunks that can reach into the image. */
  readonly candidateSplats: number;
  /** Splats drawn. */
  readonly visibleSplats: number;
  /**
   * Most error of drawn blobs in pixels, as in `maxErrorPx` of a detail: as requested, or as a budget
   * of splats requires. Null if every splat was drawn.
   */
  readonly cutErrorPx: number | null;
  /** Rasteriser that drew them. */
  readonly rasterizer: FrameRasterizer;
  /**
   * Pairs of a visible splat and a bin that it may touch, drawn or not; null if the frame had no tile
   * lists.
   */
  readonly tilePairs: number | null;
  /** Time of a sample of quads drawn besides the image, to compare rasterisers; null if none. */
  readonly quadsSampleMs: number | null;
  readonly timing: StageTimings;
}
