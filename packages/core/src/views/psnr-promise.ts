import { type CutPoint, MOST_SHARE, predictPsnrDb, predictShare } from '../data/accuracy/cut-curve.ts';
import type { FixedDetail } from '../frame/detail.ts';
import type { FramePlan } from '../frame/frame-plan.ts';
import type { FrameRequest } from '../frame/frame-request.ts';
import type { DetailChoice } from '../measure/choose-detail.ts';

/** Measures a frame and chooses its detail: see `chooseDetail`. */
export type MeasureDetail = (
  minPsnrDb: number,
  frame: FrameRequest,
  options: { readonly before: readonly CutPoint[]; readonly signal: AbortSignal },
) => Promise<DetailChoice>;

/**
 * Moving frames are not measured, so their predicted PSNR must exceed the target by this margin.
 */
const MARGIN_DB = 3;
/**
 * Additional margin for each factor of two between the measured and the current scale of the scene.
 * At twice the distance, the same share of splats differed by up to 6 dB, in 60 random views of
 * each of three scenes.
 */
const MARGIN_PER_OCTAVE_DB = 6;

/**
 * Finds the fewest splats with which images reach a PSNR: measured at rest, predicted in motion.
 */
export class PsnrPromise {
  readonly #minPsnrDb: number;
  readonly #measure: MeasureDetail;
  /** Cuts of the last measurement. */
  #measuredCuts: readonly CutPoint[] = [];
  /** Pixels per unit at the centre of the first cloud: at the last measurement, and now. */
  #measuredScalePx = 0;
  #scalePx = 0;
  /** The choice for the image at rest; null until measured. */
  #choice: { readonly detail: FixedDetail; readonly psnrDb: number | null } | null = null;

  constructor(minPsnrDb: number, measure: MeasureDetail) {
    this.#minPsnrDb = minPsnrDb;
    this.#measure = measure;
  }

  /** Detail of moving frames; full before the first measurement. */
  get moving(): FixedDetail {
    if (this.#measuredCuts.length === 0) return 'full';
    const octaves = Math.abs(Math.log2(this.#scalePx / this.#measuredScalePx));
    const marginDb = MARGIN_DB + MARGIN_PER_OCTAVE_DB * octaves;
    const share = predictShare(this.#measuredCuts, this.#minPsnrDb + marginDb);
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
    if (drawn === 'full' || drawn.maxShare === undefined || this.#measuredCuts.length === 0) return null;
    return predictPsnrDb(this.#measuredCuts, drawn.maxShare);
  }

  /**
   * Clears the choice at rest, because something moves; clears the cuts too if the clouds have
   * changed.
   */
  move(plan: FramePlan, showsOthers: boolean): void {
    this.#choice = null;
    this.#scalePx = scalePxOf(plan);
    if (showsOthers) this.#measuredCuts = [];
  }

  /**
   * Measures the image at rest; it is drawn in full if that fails. @throws errors of `chooseDetail`
   */
  async rest(frame: FrameRequest, signal: AbortSignal): Promise<void> {
    if (this.#choice) return;
    try {
      const choice = await this.#measure(this.#minPsnrDb, frame, { before: this.#measuredCuts, signal });
      signal.throwIfAborted();
      this.#choice = choice;
      // If no splat is in sight, all images are equal and their PSNR is infinite.
      const finite = choice.measured.filter(({ psnrDb }) => Number.isFinite(psnrDb));
      if (finite.length === 0) return;
      this.#measuredCuts = finite;
      this.#measuredScalePx = this.#scalePx;
    } catch (error) {
      if (!signal.aborted) this.#choice = { detail: 'full', psnrDb: null };
      throw error;
    }
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
