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
/** Splats take at least this part of the time that a frame takes without any: fewer gain little. */
const LEAST_PART = 0.5;
/** The least that a budget may be. */
const LEAST_SPLATS = 1000;
/** The first frame may take so many times as long as others: buffers are new, and clocks low. */
const FIRST_SLOWER = 4;
/** Frames that differ by this factor in splats tell what a splat takes. */
const APART = 1.25;

interface Measured {
  readonly splats: number;
  readonly ms: number;
}

/**
 * Finds how many splats a device draws within a time, by the times of the frames before: fewer as
 * soon as two frames in a row took longer, more while frames take clearly less, and all where fewer
 * would take about as long. A single slow frame changes nothing.
 */
export class FramePace {
  readonly #maxFrameMs: number;
  /** Most splats of a frame; Infinity where all are drawn in time. */
  #budget = Number.POSITIVE_INFINITY;
  #last: Measured | null = null;
  /** The last frame that was apart from that. */
  #other: Measured | null = null;

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
    const last = { splats, ms: timeOf(timing) };
    const before = this.#last;
    if (before && areApart(before, last)) this.#other = before;
    this.#last = last;
    const quicker = before ? (before.ms / before.splats) * splats : last.ms / FIRST_SLOWER;
    const ms = Math.min(last.ms, quicker);
    if (ms <= this.#maxFrameMs && splats === inSight) this.#budget = Number.POSITIVE_INFINITY;
    else if (ms > this.#maxFrameMs || ms < GROWS_BELOW * this.#maxFrameMs) {
      const next = Math.round(Math.min(this.#wantedFor({ splats, ms }), MOST_GROWTH * splats));
      this.#budget = next >= inSight ? Number.POSITIVE_INFINITY : Math.max(LEAST_SPLATS, next);
    }
  }

  /** Splats that are drawn in time if a frame takes a constant time and another for each splat. */
  #wantedFor({ splats, ms }: Measured): number {
    const other = this.#other;
    const slope = other ? (ms - other.ms) / (splats - other.splats) : Number.POSITIVE_INFINITY;
    const splatMs = Math.min(Math.max(slope, 0), ms / splats);
    const constantMs = ms - splatMs * splats;
    return Math.max(AIM * this.#maxFrameMs - constantMs, LEAST_PART * constantMs) / splatMs;
  }
}

function areApart(a: Measured, b: Measured): boolean {
  return Math.max(a.splats, b.splats) > APART * Math.min(a.splats, b.splats);
}

/** The splats' own time: a host's work may lie between the passes. */
function timeOf({ source, preprocessMs, sortMs, rasterizeMs, totalMs }: StageTimings): number {
  return source === 'gpu-timestamps' ? preprocessMs + sortMs + rasterizeMs : totalMs;
}
