/** Work of one stage, to be submitted. */
export interface Work {
  readonly stage: string;
  /** Time on the slowest known device, ms. Comparable within a stage only. */
  readonly slowestMs: number;
  /** Whether `slowestMs` is a guess: its measured time then does not predict other stages. */
  readonly isGuess?: boolean;
}

/** Submissions aim at this part of the budget, so that one may take four times its prediction. */
const AIM = 1 / 4;
/** An unmeasured stage's share of `slowestMs` is assumed to be this many times the measured average. */
const UNKNOWN_STAGE = 8;
/**
 * Least factor by which a measurement lowers a stage's prediction: the next work may be harder.
 * Predictions rise at once.
 */
const LEAST_FALL = 1 / 4;
/**
 * Least time in ms that counts for a submission with a longer prediction: the clocks of some
 * browsers have a resolution of 1 ms.
 */
const LEAST_MS = 1;

/**
 * Divides the work of frames into submissions that stay within a budget. For each stage it predicts
 * this device's time as a share of the slowest device's time, from earlier submissions. The first
 * prediction is the slowest device's own time.
 */
export class SubmissionPacer {
  readonly #aimMs: number;
  /** Predicted share of the slowest device's time, by stage. */
  readonly #shares = new Map<string, number>();
  #elapsedMs = 0;
  #slowestMs = 0;

  constructor(budgetMs: number) {
    this.#aimMs = AIM * budgetMs;
  }

  /** Returns how many of `work`, from `first` on, may be submitted together: at least one. */
  fittingFrom(first: number, work: readonly Work[]): number {
    let predictedMs = 0;
    let end = first;
    do {
      predictedMs += this.#predictMs([work[end++]]);
    } while (end < work.length && predictedMs + this.#predictMs([work[end]]) <= this.#aimMs);
    return end - first;
  }

  /**
   * Returns how many units, from `first` on, may be submitted together: at least one.
   *
   * @param slowestMs cumulative times on the slowest device: entry i for the units before unit i, and
   *   one more entry for all units.
   */
  unitsFrom(first: number, stage: string, slowestMs: Float64Array): number {
    const most = slowestMs[first] + this.#aimMs / this.#shareOf(stage);
    let [fitting, beyond] = [first + 1, slowestMs.length];
    while (fitting + 1 < beyond) {
      const middle = (fitting + beyond) >>> 1;
      if (slowestMs[middle] <= most) fitting = middle;
      else beyond = middle;
    }
    return fitting - first;
  }

  /** Updates predictions with the measured time of a submission. */
  take(work: readonly Work[], elapsedMs: number): void {
    const predictedMs = this.#predictMs(work);
    const countedMs = Math.max(elapsedMs, Math.min(LEAST_MS, predictedMs));
    const factor = countedMs / predictedMs;
    const stages = new Set(work.map(({ stage }) => stage));
    const shares = [...stages].map((stage) => [stage, this.#shareOf(stage)] as const);
    for (const [stage, share] of shares) this.#shares.set(stage, share * Math.max(factor, LEAST_FALL));
    if (work.some(({ isGuess }) => isGuess)) return;
    this.#elapsedMs += countedMs;
    this.#slowestMs += work.reduce((sum, { slowestMs }) => sum + slowestMs, 0);
  }

  #predictMs(work: readonly Work[]): number {
    return work.reduce((sum, { stage, slowestMs }) => sum + this.#shareOf(stage) * slowestMs, 0);
  }

  #shareOf(stage: string): number {
    const known = this.#shares.get(stage);
    if (known !== undefined) return known;
    return this.#slowestMs === 0 ? 1 : Math.min(1, (UNKNOWN_STAGE * this.#elapsedMs) / this.#slowestMs);
  }
}
