import type { FixedDetail } from '../frame/plan/detail.ts';
import type { StageTimings } from '../gpu/timing/frame-statistics.ts';

/** How frames are drawn in which something moves. */
export interface MovingFrame {
  readonly detail: FixedDetail;
  /** Factor of the width and height that splats are blended at: 1 or a half. */
  readonly movingScale: number;
}

/** A measured frame. */
export interface PacedFrame {
  readonly drawn: FixedDetail;
  readonly movingScale: number;
  /** Count of splats in sight, to which the budget is compared. */
  readonly inSight: number;
  /** Count of drawn splats: fewer than in sight and in the budget where parts of a scene are missing. */
  readonly visibleSplats: number;
  readonly timing: StageTimings;
}

/** Budgets aim at this share of the time, in reserve for more expensive frames. */
const AIM = 0.8;
/** A budget grows if frames take less than this share of the time. */
const GROWS_BELOW = 0.6;
/** Most growth of a budget in one step. */
const MOST_GROWTH = 1.5;
/**
 * At least this share of a budget is taken to be drawn. Budgets count blobs at the borders of the image
 * that cover nothing in it; where fewer are drawn, parts of a scene are missing, but not for long.
 */
const LEAST_VISIBLE = 0.5;
/** Least budget. */
const LEAST_SPLATS = 1000;
/** The first frame may take this many times as long, because buffers are new and GPU clocks low. */
const FIRST_SLOWER = 4;
/** Budgets that differ by less than this factor count as the same: estimates waver. */
const WAVERING = 1.25;
/** The time per splat is estimated from frames whose numbers of splats differ by this factor. */
const APART = 2;
/** The estimate uses this many of the last frames. */
const RECENT_FRAMES = 16;
/** It also uses the frame with the most splats and the one with the fewest, of this many. */
const APART_FRAMES = 128;
/** All splats are drawn again and again, though too slowly; fewer are tried after this many frames. */
const RETRIED_AFTER = 60;
/** The resolution is halved if a frame without splats takes more than this share of the time. */
const MOST_FIXED = 0.75;
/** Less would be hard to look at. */
const HALF = 0.5;
/** A lower resolution stays if the fixed time is less than this share of that before. */
const HELPS_BELOW = 0.8;

interface Measured {
  readonly splats: number;
  readonly ms: number;
}

interface Remembered extends Measured {
  /** Number of the frame. */
  readonly frame: number;
}

/**
 * Finds how many splats a device draws within a time, and in how many pixels, from the times of
 * earlier frames.
 *
 * - The budget of splats shrinks when two successive frames took longer, and grows when frames take
 *   clearly less. There is no budget if fewer splats would not save time. A single slow frame changes
 *   nothing.
 * - The resolution is halved if pixels leave too little time for splats, and stays so only if frames
 *   get quicker by it.
 */
export class FramePace {
  readonly #maxFrameMs: number;
  /** Most splats per frame; Infinity if all are drawn. */
  #budget = Number.POSITIVE_INFINITY;
  #scale = 1;
  /** Whether a lower resolution may help; false once it has not. */
  #mayHalve = true;
  /** Time of a frame without splats before the resolution was halved; null once that has been judged. */
  #fixedBeforeMs: number | null = null;
  /** The last frame in this resolution, as it was measured. */
  #last: Measured | null = null;
  /** Frames in this resolution, single slow ones made good. */
  #recent: readonly Remembered[] = [];
  #frame = 0;
  /** Time per splat; null until frames with different numbers of splats were measured. */
  #splatMs: number | null = null;
  /** Frames in a row in which all splats took too long. */
  #slowWholeFrames = 0;

  /**
   * @param maxFrameMs time per frame on the GPU by its timestamps; without them, from submission to
   *   completion.
   */
  constructor(maxFrameMs: number) {
    this.#maxFrameMs = maxFrameMs;
  }

  /** How to draw frames in which something moves. */
  get moving(): MovingFrame {
    const detail = this.#budget === Number.POSITIVE_INFINITY ? 'full' : { maxSplats: this.#budget };
    return { detail, movingScale: this.#scale };
  }

  /**
   * Updates the pace after a frame. Late results do no harm, because each is judged by its own number
   * of splats, and only beside others of its resolution.
   */
  addFrame({ drawn, movingScale, inSight, visibleSplats: splats, timing }: PacedFrame): void {
    if (splats === 0) return;
    const { maxSplats = inSight } = drawn === 'full' ? {} : drawn;
    const measuredMs = timeOf(timing);
    const isWhole = maxSplats >= inSight;
    if (isWhole && movingScale === 1 && measuredMs <= this.#maxFrameMs) {
      this.#drawAll({ splats, ms: measuredMs });
      return;
    }
    if (movingScale !== this.#scale) return;
    const ms = this.#take({ splats, ms: measuredMs });
    if (ms === null) return;
    const fixedMs = Math.max(0, ms - this.#splatMsOf({ splats, ms }) * splats);
    if (this.#changesScale(fixedMs, ms - fixedMs, isWhole)) return;
    const visibleShare = Math.max(LEAST_VISIBLE, splats / Math.min(maxSplats, inSight));
    this.#setBudget({ splats, ms }, fixedMs, visibleShare, inSight);
  }

  /** All splats were drawn in time, in the full resolution. */
  #drawAll(frame: Measured): void {
    this.#budget = Number.POSITIVE_INFINITY;
    this.#setScale(1);
    this.#mayHalve = true;
    this.#last = frame;
    this.#recent = [];
    this.#splatMs = null;
    this.#slowWholeFrames = 0;
  }

  /**
   * Takes a frame. Returns its time, or that of the frame before if only this one was slow. Null for the
   * first frame in another resolution, which has none before it.
   */
  #take(frame: Measured): number | null {
    const last = this.#last;
    this.#last = frame;
    if (!last) return this.#splatMs === null ? frame.ms / FIRST_SLOWER : null;
    const ms = Math.min(frame.ms, last.ms * Math.max(1, frame.splats / last.splats));
    this.#remember({ splats: frame.splats, ms });
    this.#splatMs = slopeOf(this.#recent) ?? this.#splatMs;
    return ms;
  }

  #remember(measured: Measured): void {
    const frames = [...this.#recent, { ...measured, frame: ++this.#frame }];
    const counts = frames.map(({ splats }) => splats);
    const [fewest, most] = [Math.min(...counts), Math.max(...counts)];
    this.#recent = frames.filter(({ splats, frame }) => {
      const isExtreme = splats === fewest || splats === most;
      return this.#frame - frame < (isExtreme ? APART_FRAMES : RECENT_FRAMES);
    });
  }

  /** Time of each splat of a frame, which is all of the frame's time as long as nothing is known. */
  #splatMsOf({ splats, ms }: Measured): number {
    return Math.min(this.#splatMs ?? Number.POSITIVE_INFINITY, ms / splats);
  }

  /** @returns whether the next frames have another resolution. */
  #changesScale(fixedMs: number, splatsMs: number, isWhole: boolean): boolean {
    const before = this.#fixedBeforeMs;
    this.#fixedBeforeMs = null;
    if (before !== null && fixedMs > HELPS_BELOW * before) {
      this.#mayHalve = false;
      return this.#setScale(1);
    }
    const aimMs = AIM * this.#maxFrameMs;
    if (this.#splatMs !== null && fixedMs > MOST_FIXED * aimMs && this.#mayHalve && this.#scale === 1) {
      this.#setScale(HALF);
      this.#fixedBeforeMs = fixedMs;
      return true;
    }
    // In the full resolution the fixed time is at most four times as long, if all of it is that of pixels.
    return isWhole && this.#scale < 1 && 4 * fixedMs + splatsMs <= aimMs ? this.#setScale(1) : false;
  }

  #setScale(movingScale: number): true {
    if (movingScale !== this.#scale) {
      this.#last = null;
      this.#recent = [];
    }
    this.#scale = movingScale;
    this.#fixedBeforeMs = null;
    return true;
  }

  /** @param visibleShare the part of a budget that is drawn. */
  #setBudget({ splats, ms }: Measured, fixedMs: number, visibleShare: number, inSight: number): void {
    const splatsMs = ms - fixedMs;
    const isInTime = ms <= this.#maxFrameMs;
    if (isInTime && splatsMs >= GROWS_BELOW * (this.#maxFrameMs - fixedMs)) return;
    const aimMs = AIM * this.#maxFrameMs - fixedMs;
    // Where time is lacking, splats get as much as all else: fewer gain little, and show but fog.
    const wanted = (splats / splatsMs) * (isInTime ? aimMs : Math.max(aimMs, fixedMs));
    if (isInTime && !(wanted > splats)) return;
    const next = Math.round(Math.min(wanted, MOST_GROWTH * splats) / visibleShare);
    if (next < inSight && next < WAVERING * this.#budget && this.#budget < WAVERING * next) return;
    this.#budget = next >= inSight ? Number.POSITIVE_INFINITY : Math.max(LEAST_SPLATS, next);
    const isSlowWhole = !isInTime && this.#budget === Number.POSITIVE_INFINITY;
    this.#slowWholeFrames = isSlowWhole ? this.#slowWholeFrames + 1 : 0;
    if (this.#slowWholeFrames < RETRIED_AFTER) return;
    this.#slowWholeFrames = 0;
    this.#recent = this.#recent.slice(-1);
    this.#budget = Math.max(LEAST_SPLATS, Math.floor(inSight / APART));
  }
}

/** Time per splat by least squares, at least 0; null if the numbers of splats hardly differ. */
function slopeOf(frames: readonly Measured[]): number | null {
  const counts = frames.map(({ splats }) => splats);
  if (Math.max(...counts) < APART * Math.min(...counts)) return null;
  const meanSplats = counts.reduce((sum, splats) => sum + splats, 0) / frames.length;
  let [covariance, variance] = [0, 0];
  for (const { splats, ms } of frames) {
    covariance += (splats - meanSplats) * ms;
    variance += (splats - meanSplats) ** 2;
  }
  return Math.max(0, covariance / variance);
}

/** The time of the splats alone: work of a host may lie between the passes. */
function timeOf({ source, preprocessMs, sortMs, rasterizeMs, totalMs }: StageTimings): number {
  return source === 'gpu-timestamps' ? preprocessMs + sortMs + rasterizeMs : totalMs;
}
