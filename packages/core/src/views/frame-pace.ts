import type { FixedDetail } from '../frame/detail.ts';
import type { StageTimings } from '../gpu/timing/frame-statistics.ts';

/** A measured frame. */
export interface PacedFrame {
  readonly drawn: FixedDetail;
  /** Count of splats in sight, to which the budget is compared. */
  readonly inSight: number;
  readonly timing: StageTimings;
}

/** Budgets aim at this share of the time, in reserve for more expensive frames. */
const AIM = 0.8;
/** A budget grows if frames take less than this share of the time. */
const GROWS_BELOW = 0.6;
/** Most growth of a budget in one step. */
const MOST_GROWTH = 1.5;
/**
 * Splats get at least this share of the time that a frame takes without any, because fewer splats
 * gain little.
 */
const LEAST_PART = 0.5;
/** Least budget. */
const LEAST_SPLATS = 1000;
/** The first frame may take this many times as long, because buffers are new and GPU clocks low. */
const FIRST_SLOWER = 4;
/**
 * The time per splat is estimated from two frames whose numbers of splats differ by this factor.
 */
const APART = 1.25;

interface Measured {
  readonly splats: number;
  readonly ms: number;
}

/**
 * Finds how many splats a device draws within a time, from the times of earlier frames. The budget
 * shrinks when two successive frames took longer, and grows when frames take clearly less. There is
 * no budget if fewer splats would not save time. A single slow frame changes nothing.
 */
export class FramePace {
  readonly #maxFrameMs: number;
  /** Most splats per frame; Infinity if all are drawn in time. */
  #budget = Number.POSITIVE_INFINITY;
  #last: Measured | null = null;
  /** The last frame whose number of splats clearly differed from `#last`. */
  #other: Measured | null = null;

  /**
   * @param maxFrameMs time per frame on the GPU by its timestamps; without them, from submission to
   *   completion.
   */
  constructor(maxFrameMs: number) {
    this.#maxFrameMs = maxFrameMs;
  }

  /** Detail of frames in which something moves. */
  get moving(): FixedDetail {
    return this.#budget === Number.POSITIVE_INFINITY ? 'full' : { maxSplats: this.#budget };
  }

  /**
   * Updates the budget after a frame. Late results do no harm, because each is judged by its own
   * number of splats.
   */
  addFrame({ drawn, inSight, timing }: PacedFrame): void {
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

  /** Splats that fit into the time, if a frame takes a constant time plus a time per splat. */
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

/** The time of the splats alone: work of a host may lie between the passes. */
function timeOf({ source, preprocessMs, sortMs, rasterizeMs, totalMs }: StageTimings): number {
  return source === 'gpu-timestamps' ? preprocessMs + sortMs + rasterizeMs : totalMs;
}
