import { type CutPoint, MOST_SHARE, predictPsnrDb, predictShare } from '../data/accuracy/cut-curve.ts';
import type { FixedDetail } from '../frame/detail.ts';
import type { FramePlan } from '../frame/frame-plan.ts';
import type { FrameRequest } from '../frame/frame-request.ts';
import type { DetailChoice } from '../measure/choose-detail.ts';

/** Measures a frame, and chooses its detail: see `chooseDetail`. */
export type MeasureDetail = (
  minPsnrDb: number,
  frame: FrameRequest,
  options: { readonly before: readonly CutPoint[]; readonly signal: AbortSignal },
) => Promise<DetailChoice>;

/**
 * Moving frames, which are not measured, are to have this much more than is asked for, …
 */
const MARGIN_DB = 3;
/**
 * … and this much more for each factor of two in the size of what they show. The same share of the
 * splats had 6 dB more or less from twice as far, in 60 random views of each of three scenes.
 */
const MARGIN_PER_OCTAVE_DB = 6;

/** Finds the fewest splats whose pictures have a PSNR: at rest by measuring them, else by prediction. */
export class PsnrPromise {
  readonly #minPsnrDb: number;
  readonly #measure: MeasureDetail;
  /** Cuts that were measured last. */
  #known: readonly CutPoint[] = [];
  /** Pixels per unit of the first cloud, at its middle: when these were measured, and now. */
  #knownScalePx = 0;
  #scalePx = 0;
  /** That of the picture at rest; null until it has been measured. */
  #choice: { readonly detail: FixedDetail; readonly psnrDb: number | null } | null = null;

  constructor(minPsnrDb: number, measure: MeasureDetail) {
    this.#minPsnrDb = minPsnrDb;
    this.#measure = measure;
  }

  /** Detail of frames in which something moves; full until one has been measured. */
  get moving(): FixedDetail {
    if (this.#known.length === 0) return 'full';
    const octaves = Math.abs(Math.log2(this.#scalePx / this.#knownScalePx));
    const marginDb = MARGIN_DB + MARGIN_PER_OCTAVE_DB * octaves;
    const share = predictShare(this.#known, this.#minPsnrDb + marginDb);
    return share >= MOST_SHARE ? 'full' : { maxShare: share };
  }

  /** Detail of the picture at rest. */
  get still(): FixedDetail {
    return this.#choice?.detail ?? this.moving;
  }

  /** PSNR of the picture at rest; null until it has been measured. */
  get measuredPsnrDb(): number | null {
    return this.#choice?.psnrDb ?? null;
  }

  predictedPsnrDb(drawn: FixedDetail): number | null {
    if (drawn === 'full' || drawn.maxShare === undefined || this.#known.length === 0) return null;
    return predictPsnrDb(this.#known, drawn.maxShare);
  }

  /** Forgets the picture at rest, because something moves, and cuts of other clouds. */
  move(plan: FramePlan, showsOthers: boolean): void {
    this.#choice = null;
    this.#scalePx = scalePxOf(plan);
    if (showsOthers) this.#known = [];
  }

  /** Measures the picture at rest, which is full if that fails. @throws errors of `chooseDetail` */
  async rest(frame: FrameRequest, signal: AbortSignal): Promise<void> {
    if (this.#choice) return;
    try {
      const choice = await this.#measure(this.#minPsnrDb, frame, { before: this.#known, signal });
      signal.throwIfAborted();
      this.#choice = choice;
      // Where nothing is in sight, all pictures are equal.
      const told = choice.measured.filter(({ psnrDb }) => Number.isFinite(psnrDb));
      if (told.length === 0) return;
      this.#known = told;
      this.#knownScalePx = this.#scalePx;
    } catch (error) {
      if (!signal.aborted) this.#choice = { detail: 'full', psnrDb: null };
      throw error;
    }
  }
}

/** Pixels per unit at the middle of the first cloud, in that cloud's units. */
function scalePxOf({ clouds: [first], projection: { focalPx, isOrthographic } }: FramePlan): number {
  const focal = Math.abs(focalPx[0]);
  if (isOrthographic || !first?.view.camera) return focal;
  const { origin, robustBounds } = first.instance.cloud;
  const toMiddle = first.view.camera.map(
    (at, axis) => (robustBounds.min[axis] + robustBounds.max[axis]) / 2 - origin[axis] - at,
  );
  return focal / Math.hypot(...toMiddle, Number.MIN_VALUE);
}
