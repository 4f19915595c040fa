/** Milliseconds of one picture. */
export interface StageTimings {
  /**
   * `gpu-timestamps`: measured by the GPU at the ends of its passes. `wall-clock`: this device has no timestamps, so
   * only `totalMs` is known, from submission to completion, and the stages are NaN.
   */
  readonly source: 'gpu-timestamps' | 'wall-clock';
  /** Cull, project, colours; like the sort 0 where an embedded view kept what it had, as nothing moved. */
  readonly preprocessMs: number;
  readonly sortMs: number;
  /** Drawing the splats and putting them over what is behind. */
  readonly rasterizeMs: number;
  /** From the first pass to the last; inside another renderer's frame that includes what it drew in between. */
  readonly totalMs: number;
  /** From submission to completion as the CPU saw it: includes waiting for earlier pictures and for the browser. */
  readonly wallClockMs: number;
}

/** What is known without timestamps: the whole, by the wall clock. */
export function wallClockTimings(wallClockMs: number): StageTimings {
  const unknown = Number.NaN;
  return {
    source: 'wall-clock',
    preprocessMs: unknown,
    sortMs: unknown,
    rasterizeMs: unknown,
    totalMs: wallClockMs,
    wallClockMs,
  };
}

/** Beyond this factor and this time apart, timestamps and wall clock do not tell of the same work. */
const PLAUSIBLE_FACTOR = 3;
const PLAUSIBLE_DIFFERENCE_MS = 20;

/**
 * Whether GPU timestamps fit what the CPU saw. Some browsers have been seen to report a hundredth of the true time; a
 * few milliseconds more on the wall clock are the browser's own.
 */
export function isPlausible({ totalMs, wallClockMs }: StageTimings): boolean {
  const ratio = Math.max(totalMs, wallClockMs) / Math.min(totalMs, wallClockMs);
  return ratio <= PLAUSIBLE_FACTOR || Math.abs(totalMs - wallClockMs) <= PLAUSIBLE_DIFFERENCE_MS;
}

/** What is known of one picture, some frames after it was drawn. */
export interface FrameStatistics {
  /** Number of the picture, from 1. */
  readonly frame: number;
  readonly loadedSplats: number;
  /** Splats in the chunks that can reach into the picture. */
  readonly candidateSplats: number;
  /** Splats drawn. */
  readonly visibleSplats: number;
  readonly timing: StageTimings;
}
