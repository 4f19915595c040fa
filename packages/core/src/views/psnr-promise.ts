import type { FixedDetail } from '../frame/detail.ts';
import type { FrameRequest } from '../frame/frame-request.ts';
import type { DetailChoice } from '../measure/choose-detail.ts';
import { type CutPoint, MOST_SHARE, predictPsnrDb, predictShare } from '../measure/cut-curve.ts';

/** Measures a frame, and chooses its detail: see `chooseDetail`. */
export type MeasureDetail = (
  minPsnrDb: number,
  frame: FrameRequest,
  options: { readonly before: readonly CutPoint[]; readonly signal: AbortSignal },
) => Promise<DetailChoice>;

/** Moving frames, which are not measured, are to have this much more than is asked for. */
const MARGIN_DB = 3;

/** Finds the fewest splats whose pictures have a PSNR: at rest by measuring them, else by prediction. */
export class PsnrPromise {
  readonly #minPsnrDb: number;
  readonly #measure: MeasureDetail;
  /** Cuts that were measured last, from wherever. */
  #known: readonly CutPoint[] = [];
  /** That of the picture at rest; null until it has been measured. */
  #choice: DetailChoice | null = null;

  constructor(minPsnrDb: number, measure: MeasureDetail) {
    this.#minPsnrDb = minPsnrDb;
    this.#measure = measure;
  }

  /** Detail of frames in which something moves; full until one has been measured. */
  get moving(): FixedDetail {
    if (this.#known.length === 0) return 'full';
    const share = predictShare(this.#known, this.#minPsnrDb + MARGIN_DB);
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
    if (drawn === 'full' || drawn.maxShare === undefined) return null;
    return predictPsnrDb(this.#known, drawn.maxShare);
  }

  /** Forgets the picture at rest, because something moves, and cuts of other clouds. */
  move(showsOthers: boolean): void {
    this.#choice = null;
    if (showsOthers) this.#known = [];
  }

  /** Measures the picture at rest. @throws errors of `chooseDetail` */
  async rest(frame: FrameRequest, signal: AbortSignal): Promise<void> {
    if (this.#choice) return;
    const choice = await this.#measure(this.#minPsnrDb, frame, { before: this.#known, signal });
    signal.throwIfAborted();
    this.#choice = choice;
    if (choice.measured.length > 0) this.#known = choice.measured;
  }
}
