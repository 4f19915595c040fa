/** A peak stands for this many frames at least. */
const PERIOD_FRAMES = 30;

/** Room that was not needed for this long is given back. */
export const ROOM_PERIOD_MS = 5000;
/** Room is given back when less than this share of it was needed by all recent frames. */
export const LEAST_USE = 0.4;
/** Spare room is up to half of a need: it may be given back once less than this share is needed. */
const FALLEN = 1.5 * LEAST_USE;

/**
 * The largest of the recent values of a need, by which room is given back. Time alone is not
 * recent: a view at rest draws nothing, and its next need is not known.
 *
 * If the need returns after its room was given back, as in every round of an orbit, the peak stands
 * four times as long from then on. A motion that repeats is thus soon left alone, however slow it
 * is.
 */
export class RecentPeak {
  readonly #periodMs: number;
  #before = 0;
  #recent = 0;
  #frames = 0;
  #since = 0;
  #patience = 1;
  /** Largest value since room was given back; then `#former`. */
  #highest = 0;
  #former = Number.POSITIVE_INFINITY;

  /** @param periodMs least time that a peak stands; at most twice that, if frames are drawn. */
  constructor(periodMs = ROOM_PERIOD_MS) {
    this.#periodMs = periodMs;
  }

  /** 0 before the first value. */
  get value(): number {
    return Math.max(this.#before, this.#recent);
  }

  /**
   * Takes the need of a frame.
   *
   * @param atMs when it was drawn, by a clock that never goes back.
   */
  take(value: number, atMs: number): void {
    if (value > FALLEN * this.#former) {
      this.#patience *= 4;
      // As much as then, at once: every step takes time.
      this.#recent = this.#former;
      this.#former = Number.POSITIVE_INFINITY;
    }
    this.#highest = Math.max(this.#highest, value);
    this.#recent = Math.max(this.#recent, value);
    if (this.#frames++ === 0) this.#since = atMs;
    const isOver =
      this.#frames >= this.#patience * PERIOD_FRAMES && atMs - this.#since >= this.#patience * this.#periodMs;
    if (!isOver) return;
    this.#before = this.#recent;
    this.#recent = 0;
    this.#frames = 0;
    if (this.#before >= FALLEN * this.#highest) return;
    this.#former = this.#highest;
    this.#highest = this.#before;
  }
}
