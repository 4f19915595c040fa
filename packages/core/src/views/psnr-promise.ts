import {
  type CutPoint,
  MOST_SHARE,
  predictCertainShare,
  predictPsnrDb,
  predictShare,
} from '../data/accuracy/cut-curve.ts';
import type { FixedDetail } from '../frame/plan/detail.ts';
import type { FramePlan } from '../frame/plan/frame-plan.ts';
import type { FrameRequest } from '../frame/plan/frame-request.ts';
import type { DetailChoice } from '../measure/choose-detail.ts';

type FindCuts<Found> = (
  minPsnrDb: number,
  frame: FrameRequest,
  options: { readonly before: readonly CutPoint[]; readonly signal: AbortSignal },
) => Promise<Found>;

/** How cuts are found: see `chooseDetail` and `predictCuts`. */
export interface CutFinders {
  readonly measureDetail: FindCuts<DetailChoice>;
  readonly predictCuts: FindCuts<readonly CutPoint[]>;
}

/**
 * Moving frames are not measured, so their predicted PSNR must exceed the target by this margin. 19
 * of 20 predictions promise less than this too much.
 */
const MARGIN_DB = 3;
/**
 * Additional margin for each factor of two between the scale of the scene where cuts were found and
 * the current one. At twice the distance, the same share of splats differed by up to 6 dB, in 60
 * random views of each of three scenes.
 */
const MARGIN_PER_OCTAVE_DB = 6;

/**
 * Finds the fewest splats with which images reach a PSNR: measured at rest, predicted in motion.
 */
export class PsnrPromise {
  readonly #minPsnrDb: number;
  readonly #finders: CutFinders;
  /** Cuts that were measured or predicted last. */
  #cuts: readonly CutPoint[] = [];
  #areMeasured = false;
  /** Pixels per unit at the centre of the first cloud: for these cuts, and now. */
  #cutsScalePx = 0;
  #scalePx = 0;
  /** The choice for the image at rest; null until measured. */
  #choice: { readonly detail: FixedDetail; readonly psnrDb: number | null } | null = null;

  constructor(minPsnrDb: number, finders: CutFinders) {
    this.#minPsnrDb = minPsnrDb;
    this.#finders = finders;
  }

  /** Detail of moving frames; full before cuts are known. */
  get moving(): FixedDetail {
    if (this.#cuts.length === 0) return 'full';
    const octaves = Math.abs(Math.log2(this.#scalePx / this.#cutsScalePx));
    const marginDb = MARGIN_DB + MARGIN_PER_OCTAVE_DB * octaves;
    const predict = this.#areMeasured ? predictShare : predictCertainShare;
    const share = predict(this.#cuts, this.#minPsnrDb + marginDb);
    return share >= MOST_SHARE ? 'full' : { maxShare: share };
  }

  /** Detail of the image at rest. */
  get still(): FixedDetail {
    return this.#choice?.detail ?? this.moving;
  }

  /** PSNR of the image at rest, dB; null until measured. */
  get measuredPsnrDb(): number | null {
    return this.#choice?.psnrDb ?? null;
  }

  predictedPsnrDb(drawn: FixedDetail): number | null {
    return drawn === 'full' || drawn.maxShare === undefined
      ? null
      : predictPsnrDb(this.#cuts, drawn.maxShare);
  }

  /**
   * Clears the choice at rest, because something moves; clears the cuts too if the clouds have
   * changed.
   */
  move(plan: FramePlan, showsOthers: boolean): void {
    this.#choice = null;
    this.#scalePx = scalePxOf(plan);
    if (showsOthers) this.#cuts = [];
  }

  /** Predicts cuts from the camera of a moving frame. @throws errors of `predictCuts` */
  async predict(frame: FrameRequest, signal: AbortSignal): Promise<void> {
    const scalePx = this.#scalePx;
    const options = { before: this.#cuts, signal };
    const cuts = await this.#finders.predictCuts(this.#minPsnrDb + MARGIN_DB, frame, options);
    signal.throwIfAborted();
    this.#take(cuts, scalePx, false);
  }

  /**
   * Measures the image at rest; it is drawn in full if that fails. @throws errors of `chooseDetail`
   */
  async rest(frame: FrameRequest, signal: AbortSignal): Promise<void> {
    if (this.#choice) return;
    try {
      const options = { before: this.#cuts, signal };
      const choice = await this.#finders.measureDetail(this.#minPsnrDb, frame, options);
      signal.throwIfAborted();
      this.#choice = choice;
      this.#take(choice.measured, this.#scalePx, true);
    } catch (error) {
      if (!signal.aborted) this.#choice = { detail: 'full', psnrDb: null };
      throw error;
    }
  }

  #take(cuts: readonly CutPoint[], scalePx: number, areMeasured: boolean): void {
    // If no splat is in sight, all images are equal and their PSNR is infinite.
    if (!cuts.some(({ psnrDb }) => Number.isFinite(psnrDb))) return;
    this.#cuts = cuts;
    this.#areMeasured = areMeasured;
    this.#cutsScalePx = scalePx;
  }
}

/** Pixels per unit at the centre of the first cloud, in the cloud's units. */
function scalePxOf({ clouds: [first], projection: { focalPx, isOrthographic } }: FramePlan): number {
  const focal = Math.abs(focalPx[0]);
  if (isOrthographic || !first?.view.camera) return focal;
  const { origin, robustBounds } = first.instance.cloud;
  const toMiddle = first.view.camera.map(
    (at, axis) => (robustBounds.min[axis] + robustBounds.max[axis]) / 2 - origin[axis] - at,
  );
  return focal / Math.hypot(...toMiddle, Number.MIN_VALUE);
}
