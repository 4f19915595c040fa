import type { FixedDetail } from '../frame/detail.ts';
import type { StageTimings } from '../gpu/timing/frame-statistics.ts';

/** A frame that has been measured. */
export interface PacedFrame {
  readonly drawn: FixedDetail;
  /** Splats in sight: what its budget is held against. */
  readonly inSight: number;
  readonly timing: StageTimings;
}

/** Budgets aim at this part of the time: the next frame may show what is dearer. */
const AIM = 0.8;
/** A budget grows again where frames take less than this part of the time, … */
const GROWS_BELOW = 0.6;
/** … by no more than this factor at once. */
const MOST_GROWTH = 1.5;
/** The least that a budget may be: fewer splats take hardly any less time. */
const LEAST_SPLATS = 1000;

/**
 * Finds how many splats a device draws within a time, by the times of the frames before: fewer as
 * soon as two frames in a row took longer, more while frames take clearly less. A single slow frame
 * changes nothing.
 */
export class FramePace {
  readonly #maxFrameMs: number;
  /** Most splats of a frame; Infinity where all are drawn in time. */
  #budget = Number.POSITIVE_INFINITY;
  /** Of the frame before: its time for each splat of its budget. */
  #splatMs = Number.POSITIVE_INFINITY;

  /** @param maxFrameMs time on the GPU, by its timestamps; without, from submission to the end. */
  constructor(maxFrameMs: number) {
    this.#maxFrameMs = maxFrameMs;
  }

  /** Detail of frames in which something moves. */
  get moving(): FixedDetail {
    return this.#budget === Number.POSITIVE_INFINITY ? 'full' : { maxSplats: this.#budget };
  }

  /** Takes a frame's time. Late ones do no harm: each tells by itself what would be in time. */
  learn({ drawn, inSight, timing }: PacedFrame): void {
    const { maxSplats = inSight } = drawn === 'full' ? {} : drawn;
    const splats = Math.min(maxSplats, inSight);
    if (splats === 0) return;
    const splatMs = timeOf(timing) / splats;
    const part = (Math.min(splatMs, this.#splatMs) * splats) / this.#maxFrameMs;
    this.#splatMs = splatMs;
    const isFull = splats === inSight;
    if (part <= 1 && isFull) this.#budget = Number.POSITIVE_INFINITY;
    else if (part > 1 || part < GROWS_BELOW) {
      const next = Math.round(splats * Math.min(AIM / part, MOST_GROWTH));
      this.#budget = next >= inSight ? Number.POSITIVE_INFINITY : Math.max(LEAST_SPLATS, next);
    }
  }
}

/** The splats' own time: a host's work may lie between the passes. */
function timeOf({ source, preprocessMs, sortMs, rasterizeMs, totalMs }: StageTimings): number {
  return source === 'gpu-timestamps' ? preprocessMs + sortMs + rasterizeMs : totalMs;
}
