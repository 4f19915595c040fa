/** Work of one stage, to be submitted. */
export interface Work {
  readonly stage: string;
  /** Time of the slowest device, ms; comparable within a stage: other stages may be far off. */
  readonly slowestMs: number;
  /** Whether `slowestMs` is a guess, which tells nothing of other stages. */
  readonly isGuess?: boolean;
}

/** Submissions aim at this part of the budget, so that one may take four times its prediction. */
const AIM = 1 / 4;
/** Factor that an unmeasured stage may be slower by, next to the slowest device, than others. */
const UNKNOWN_STAGE = 8;
/**
 * A stage's prediction falls to no less than this part of the last: work that follows may be
 * harder. It rises at once.
 */
const LEAST_FALL = 1 / 4;
/**
 * Work that was foreseen to take longer is not taken for shorter than this, ms: clocks of browsers
 * tell whole ones, or less.
 */
const LEAST_MS = 1;

/**
 * Divides the work of frames into submissions that stay within a budget, by the times of those
 * before. Predicts the part of the slowest device's time that this one takes, by stage. Begins with
 * that device's own times.
 */
export class SubmissionPacer {
  readonly #aimMs: number;
  /** By stage: the part of the slowest device's time that it is predicted to take. */
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
   * @param slowestMs per unit: the slowest device's time for those before it, and at last for all.
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

  /** Takes the time of a submission. */
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
