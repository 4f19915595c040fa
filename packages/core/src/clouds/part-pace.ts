/** Part of the time from frame to frame by which parts may delay a frame. */
const DELAY_SHARE = 1 / 4;
/** Weight of a frame in what frames take. */
const LEARNT_SHARE = 1 / 4;
/** Most frames in time before the next attempt to have more parts. */
const MOST_PATIENCE = 32;

/**
 * How many parts of a scene come or go between two frames of a view that moves: one more after
 * frames that were in time although as many as that had come, and half as many after a late one.
 * The more frames were late, the more have to be in time.
 */
export class PartPace {
  #most = 1;
  /** Time of a frame after one part or none, ms; undefined before the first. */
  #plainMs: number | undefined;
  #patience = 1;
  #inTime = 0;

  /** Parts that may come or go after a frame, at least 1. */
  get most(): number {
    return this.#most;
  }

  /**
   * Takes a frame.
   *
   * @param parts that came or went since the frame before.
   * @param frameMs from its beginning until the device has done it.
   * @param stepMs from the beginning of the frame before to that of this one.
   */
  learn(parts: number, frameMs: number, stepMs: number): void {
    const plainMs = this.#plainMs ?? frameMs;
    if (parts <= 1) this.#plainMs = plainMs + LEARNT_SHARE * (frameMs - plainMs);
    if (parts === 0) this.#patience = 1;
    else if (frameMs > plainMs + DELAY_SHARE * stepMs) this.#slowDown(parts);
    else if (parts >= this.#most && ++this.#inTime >= this.#patience) {
      this.#most++;
      this.#inTime = 0;
    }
  }

  #slowDown(parts: number): void {
    this.#most = Math.max(1, Math.floor(Math.min(parts, this.#most) / 2));
    this.#patience = Math.min(MOST_PATIENCE, 2 * this.#patience);
    this.#inTime = 0;
  }
}
