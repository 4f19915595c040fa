import type { FrameRasterizer } from '../data/accuracy/accuracy.ts';
import type { QuadsSample } from '../frame/parts/frame-part.ts';
import type { FramePlan } from '../frame/plan/frame-plan.ts';
import type { FrameShape } from '../frame/plan/frame-shape.ts';
import type { FrameStatistics } from '../gpu/timing/frame-statistics.ts';
import type { RasterizeDepth } from '../stages/quads/quads.ts';

/** A view's rasteriser, and the measured times of both. */
export interface RasterizerReport {
  readonly rasterizer: FrameRasterizer;
  /** Reason of the choice, for people. */
  readonly reason: string;
  /** Median time of recent frames, ms; null if unknown. */
  readonly tilesMs: number | null;
  /** Median time by quads, ms; estimated from samples if quads have not drawn whole frames. */
  readonly quadsMs: number | null;
}

/** A frame that was drawn and timed. */
export interface TimedFrame {
  readonly rasterizer: FrameRasterizer;
  /** Time of drawing the splats, ms; without timestamps, of the whole frame. */
  readonly elapsedMs: number;
  readonly visibleSplats: number;
  readonly pixels: number;
  /** Time of the sample of quads drawn with the frame, ms; null if none was. */
  readonly sampleMs: number | null;
}

export interface RasterizerChoiceOptions {
  /** Whether the GPU times its passes with timestamps, which samples need. */
  readonly hasTimestamps: boolean;
  /** The faster rasteriser of earlier comparisons on this adapter; null if unknown. */
  readonly remembered: FrameRasterizer | null;
  /** Called with the faster rasteriser after a comparison. */
  readonly remember: (rasterizer: FrameRasterizer) => void;
}

/** Number of frames for the median. */
const FRAMES = 5;
/**
 * Shares of the quads that samples draw, in ascending order, as long as the next is cheap enough.
 * The first measures an empty pass.
 */
const SAMPLE_SHARES = [0, 1 / 1024, 1 / 128, 1 / 16] as const;
/** Samples per share; their median counts. */
const SAMPLES = 3;
/** Most time of a sample, as a share of a frame's time. */
const LONGEST_SAMPLE = 0.4;
/** The other rasteriser is tried if it is expected to take less than this share of the time. */
const HYSTERESIS = 0.87;
/**
 * Tiles are tried if expected to take at most this many times as long as quads, because the
 * estimate is rough.
 */
const WORTH_A_TRY = 1.3;
/** Factor of change in visible splats or pixels after which both are compared again. */
const MOVED = 1.6;
/** Least number of frames between two comparisons. */
const REST_FRAMES = 60;

interface Load {
  readonly visibleSplats: number;
  readonly pixels: number;
}

interface RasterizerTime {
  readonly elapsedMs: number;
  readonly load: Load;
}

/**
 * Chooses between the two rasterisers by their times on this device and view. Tiles draw first,
 * unless quads were faster on this adapter before. While tiles draw, growing samples of the quads
 * are drawn too, into places of the layer that tiles then overwrite. Their times predict the time
 * of all quads; no frame is slowed by more than LONGEST_SAMPLE. The other rasteriser draws whole
 * frames only if it promises to be faster, and stays only if it is.
 */
export class RasterizerChoice {
  readonly #options: RasterizerChoiceOptions;
  #rasterizer: FrameRasterizer;
  #reason: string;
  readonly #times: Record<FrameRasterizer, RasterizerTime | null> = { tiles: null, quads: null };
  #hasRejectedTiles = false;
  #recent: number[] = [];
  /** Load of the first of these frames; frames of other loads are not comparable. */
  #recentLoad: Load | null = null;
  /** Index of the next sample; null if none is due. */
  #step: number | null = null;
  #samples: number[] = [];
  /** Time of a sample without quads, ms. */
  #emptySampleMs = 0;
  /** Whether the current rasteriser draws only for the comparison. */
  #isTrial = false;
  #comparedAt: Load | null = null;
  #restFrames = 0;

  constructor(options: RasterizerChoiceOptions) {
    this.#options = options;
    this.#rasterizer = options.remembered ?? 'tiles';
    this.#reason = options.remembered
      ? `${options.remembered} were faster on this device before`
      : 'not timed against quads yet';
  }

  /** The rasteriser for the next frame. */
  get rasterizer(): FrameRasterizer {
    return this.#rasterizer;
  }

  /** Share of the quads that the next frame draws as a sample; null for none. */
  get sampleShare(): number | null {
    return this.#step === null ? null : SAMPLE_SHARES[this.#step];
  }

  get report(): RasterizerReport {
    const { tiles, quads } = this.#times;
    return {
      rasterizer: this.#rasterizer,
      reason: this.#reason,
      tilesMs: tiles?.elapsedMs ?? null,
      quadsMs: quads?.elapsedMs ?? null,
    };
  }

  /** The report for a view whose last frame has this shape; `shape` is null before the first. */
  reportOf(shape: FrameShape | null): RasterizerReport {
    const { report } = this;
    if (!shape) return report;
    const { rasterizer, accuracy, depth } = shape;
    const because = (reason: string) => ({ ...report, rasterizer, reason });
    if (rasterizer === accuracy.rasterizer) return because(`${rasterizer} were asked for`);
    if (!depth?.layerFormat || rasterizer === report.rasterizer) return report;
    const isTiles = rasterizer === 'tiles';
    return because(
      isTiles ? 'only tiles write the median of depth' : 'tiles cannot write depth on this device',
    );
  }

  /**
   * The rasteriser for frames with this depth. Frames that write depth use tiles, whose depth is
   * better, unless tiles were rejected.
   */
  rasterizerFor(depth: RasterizeDepth | null): FrameRasterizer {
    if (!depth?.layerFormat) return this.#rasterizer;
    return this.#hasRejectedTiles ? 'quads' : 'tiles';
  }

  /**
   * The sample of quads to draw with a frame; null for none. @param last statistics of the previous
   * frame.
   */
  sampleFor({ shape }: FramePlan, last: FrameStatistics | null): QuadsSample | null {
    const share = this.sampleShare;
    if (share === null || !last || shape.accuracy.rasterizer !== 'auto') return null;
    return { share, visibleSplats: last.visibleSplats };
  }

  /**
   * Updates the choice after a measured frame.
   *
   * @param tooMany reason why the frame has too many splats for tiles; null if it has not.
   */
  addStatistics(plan: FramePlan, statistics: FrameStatistics, tooMany: string | null): void {
    if (plan.shape.accuracy.rasterizer !== 'auto') return;
    const { tilePairs, rasterizer, quadsSampleMs, visibleSplats, timing } = statistics;
    const pixels = plan.layer.widthPx * plan.layer.heightPx;
    if (tooMany !== null) this.rejectTiles(tooMany, { visibleSplats, pixels });
    // If the lists of tiles overflowed, the frame ran the stages of both rasterisers.
    if (tilePairs !== null && rasterizer === 'quads') return;
    const elapsedMs = timing.source === 'gpu-timestamps' ? timing.rasterizeMs : timing.wallClockMs;
    this.take({ rasterizer, elapsedMs, visibleSplats, pixels, sampleMs: quadsSampleMs });
  }

  /** Uses quads until the load has changed, because tiles cannot draw this view. */
  rejectTiles(reason: string, load: Load): void {
    this.#switch('quads', reason);
    this.#hasRejectedTiles = true;
    this.#isTrial = false;
    this.#comparedAt = load;
  }

  /** Adds the time of a frame; frames of the other rasteriser are ignored. */
  take(frame: TimedFrame): void {
    if (frame.rasterizer !== this.#rasterizer) return;
    if (frame.sampleMs !== null) {
      this.#takeSample(frame.sampleMs, frame);
      return;
    }
    if (this.#recentLoad && hasMoved(this.#recentLoad, frame)) this.#recent = [];
    if (this.#recent.length === 0) this.#recentLoad = loadOf(frame);
    this.#recent.push(frame.elapsedMs);
    if (this.#recent.length > FRAMES) this.#recent.shift();
    if (this.#recent.length < FRAMES) return;
    this.#times[this.#rasterizer] = { elapsedMs: medianOf(this.#recent), load: loadOf(frame) };
    if (this.#isTrial) this.#endTrial(frame);
    else if (this.#isCheckDue(frame)) this.#check(frame);
  }

  #isCheckDue(frame: Load): boolean {
    if (this.#step !== null) return false;
    this.#restFrames++;
    if (!this.#comparedAt) return true;
    return this.#restFrames >= REST_FRAMES && hasMoved(this.#comparedAt, frame);
  }

  #check(frame: Load): void {
    this.#restFrames = 0;
    if (this.#rasterizer === 'tiles' && this.#options.hasTimestamps) {
      this.#step = 0;
      this.#samples = [];
      return;
    }
    const now = this.#times[this.#rasterizer]!.elapsedMs;
    const other = this.#times[otherThan(this.#rasterizer)];
    // Without an estimate, only trying the other rasteriser gives its time.
    const expected = other ? other.elapsedMs * growth(other.load, frame) : 0;
    if (expected <= WORTH_A_TRY * now) this.#try(otherThan(this.#rasterizer));
    else this.#settle(frame);
  }

  #takeSample(sampleMs: number, frame: TimedFrame): void {
    const step = this.#step;
    const tiles = this.#times.tiles;
    if (step === null || !tiles) return;
    this.#samples.push(sampleMs);
    if (this.#samples.length < SAMPLES) return;
    const medianMs = medianOf(this.#samples);
    this.#samples = [];
    if (step === 0) {
      this.#emptySampleMs = medianMs;
      this.#step = 1;
      return;
    }
    const estimateMs = Math.max(0, medianMs - this.#emptySampleMs) / SAMPLE_SHARES[step];
    const next = step + 1;
    if (next < SAMPLE_SHARES.length && estimateMs * SAMPLE_SHARES[next] <= LONGEST_SAMPLE * tiles.elapsedMs) {
      this.#step = next;
      return;
    }
    this.#step = null;
    this.#times.quads = { elapsedMs: estimateMs, load: loadOf(frame) };
    if (estimateMs < HYSTERESIS * tiles.elapsedMs) this.#try('quads');
    else this.#settle(frame);
  }

  #try(rasterizer: FrameRasterizer): void {
    this.#isTrial = true;
    this.#switch(rasterizer, 'both are being compared');
  }

  #endTrial(frame: Load): void {
    this.#isTrial = false;
    const now = this.#times[this.#rasterizer]!.elapsedMs;
    const other = this.#times[otherThan(this.#rasterizer)]!.elapsedMs;
    if (now > other) this.#switch(otherThan(this.#rasterizer), '');
    this.#settle(frame);
  }

  #settle(frame: Load): void {
    this.#comparedAt = loadOf(frame);
    this.#restFrames = 0;
    const { tiles, quads } = this.#times;
    this.#reason =
      tiles && quads
        ? `on this device and view tiles took ${msOf(tiles)} and quads ${msOf(quads)}`
        : `${this.#rasterizer} were the faster here`;
    this.#options.remember(this.#rasterizer);
  }

  #switch(rasterizer: FrameRasterizer, reason: string): void {
    this.#rasterizer = rasterizer;
    this.#hasRejectedTiles = false;
    this.#reason = reason;
    this.#recent = [];
    this.#step = null;
  }
}

function otherThan(rasterizer: FrameRasterizer): FrameRasterizer {
  return rasterizer === 'tiles' ? 'quads' : 'tiles';
}

function loadOf({ visibleSplats, pixels }: Load): Load {
  return { visibleSplats, pixels };
}

function hasMoved(from: Load, to: Load): boolean {
  const factor = (a: number, b: number) => Math.max(a, b, 1) / Math.max(1, Math.min(a, b));
  return factor(from.visibleSplats, to.visibleSplats) >= MOVED || factor(from.pixels, to.pixels) >= MOVED;
}

/** Growth of the work: the geometric mean of the growth in splats and in pixels. */
function growth(from: Load, to: Load): number {
  const splats = Math.max(1, to.visibleSplats) / Math.max(1, from.visibleSplats);
  const pixels = Math.max(1, to.pixels) / Math.max(1, from.pixels);
  return Math.sqrt(splats * pixels);
}

function medianOf(values: readonly number[]): number {
  return values.toSorted((a, b) => a - b)[values.length >> 1];
}

function msOf({ elapsedMs }: RasterizerTime): string {
  return `${Number(elapsedMs.toPrecision(2))} ms`;
}
