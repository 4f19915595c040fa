/** A frame that begins later than this after the one before, ms, does not follow it. */
const LONGEST_PAUSE_MS = 500;
/** A view is at rest when no frame has begun for this many times the last pause, and for this long, ms. */
const REST_PAUSES = 2;
const LEAST_REST_MS = 50;

/**
 * The frames that a view draws by itself, not because what it shows has changed. Pauses are from the
 * end of one on the device to the beginning of the next: slow devices draw frame after frame, too.
 */
export class OwnFrames {
  #beginMs = Number.NEGATIVE_INFINITY;
  #endMs = Number.NEGATIVE_INFINITY;
  #underWay = 0;
  #stepMs = Number.POSITIVE_INFINITY;
  #pauseMs = Number.POSITIVE_INFINITY;

  /** From the beginning of the last but one to that of the last, ms. */
  get stepMs(): number {
    return this.#stepMs;
  }

  begin(nowMs: number): void {
    this.#stepMs = nowMs - this.#beginMs;
    this.#pauseMs = this.#underWay > 0 ? 0 : nowMs - this.#endMs;
    this.#beginMs = nowMs;
    this.#underWay++;
  }

  /** The last one is submitted in parts: `end` is called once more. */
  prolong(): void {
    this.#underWay++;
  }

  /** The device has done one. */
  end(nowMs: number): void {
    this.#underWay--;
    this.#endMs = nowMs;
  }

  /** How long another frame may still be on its way, ms, at least; 0 where none is to be expected. */
  restMs(nowMs: number): number {
    if (this.#pauseMs > LONGEST_PAUSE_MS) return 0;
    const restMs = Math.max(LEAST_REST_MS, REST_PAUSES * this.#pauseMs);
    return this.#underWay > 0 ? restMs : Math.max(0, this.#endMs + restMs - nowMs);
  }
}
