/**
 * A frame that begins later than this after the previous one, in milliseconds, starts a new motion.
 */
const LONGEST_PAUSE_MS = 500;
/**
 * A view is at rest after this many times the last pause without a frame, and after at least
 * LEAST_REST_MS.
 */
const REST_PAUSES = 2;
const LEAST_REST_MS = 50;

/**
 * Frames that a view draws on its own, not because streamed parts have changed. Pauses are measured
 * from the end of a frame on the device to the next beginning, so that slow devices count as moving
 * too.
 */
export class OwnFrames {
  #beginMs = Number.NEGATIVE_INFINITY;
  #endMs = Number.NEGATIVE_INFINITY;
  #underWay = 0;
  #stepMs = Number.POSITIVE_INFINITY;
  #pauseMs = Number.POSITIVE_INFINITY;

  /** Milliseconds between the beginnings of the last two frames. */
  get stepMs(): number {
    return this.#stepMs;
  }

  begin(nowMs: number): void {
    this.#stepMs = nowMs - this.#beginMs;
    this.#pauseMs = this.#underWay > 0 ? 0 : nowMs - this.#endMs;
    this.#beginMs = nowMs;
    this.#underWay++;
  }

  /** Call if the last frame is submitted in parts; `end` must then be called once more. */
  prolong(): void {
    this.#underWay++;
  }

  /** Call when the device has finished a frame. */
  end(nowMs: number): void {
    this.#underWay--;
    this.#endMs = nowMs;
  }

  /** Milliseconds for which another frame is still expected; 0 if none is. */
  restMs(nowMs: number): number {
    if (this.#pauseMs > LONGEST_PAUSE_MS) return 0;
    const restMs = Math.max(LEAST_REST_MS, REST_PAUSES * this.#pauseMs);
    return this.#underWay > 0 ? restMs : Math.max(0, this.#endMs + restMs - nowMs);
  }
}
