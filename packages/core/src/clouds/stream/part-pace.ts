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

/** Weight of a new frame in the running mean of frame times. */
const MEAN_WEIGHT = 1 / 4;
/** Most frames in time before the limit is raised again. */
const MOST_PATIENCE = 32;
/** Least time that placing parts may take on the thread between two frames, ms. */
const LEAST_MS = 1;

/** Limit of the parts to place or remove now; one part is always allowed. */
export interface PartLimit {
  readonly parts: number;
  /** Time on the thread. */
  readonly ms: number;
}

/**
 * Limits how many parts of a scene are placed or removed between two frames of a view that draws on
 * its own. The limit grows after frames that reached it in time, and halves after a late one. After
 * each late frame, twice as many must be in time before it grows.
 */
export class PartPace {
  readonly #delayShare: number;
  readonly #growthOf: (parts: number) => number;
  readonly #mostMs: number;
  #parts: number;
  #ms: number;
  /** Time of a frame after at most one part, ms; undefined before the first. */
  #plainMs: number | undefined;
  #patience = 1;
  #inTime = 0;

  /**
   * @param delayShare share of the interval between frames by which placing parts may delay a frame.
   * @param growthOf by how much a limit grows.
   * @param mostMs most time that placing parts may take on the thread between two frames.
   * @param firstParts limit once the time of a frame after at most one part is known.
   */
  constructor(delayShare: number, growthOf: (parts: number) => number, mostMs: number, firstParts: number) {
    this.#delayShare = delayShare;
    this.#growthOf = growthOf;
    this.#mostMs = mostMs;
    this.#ms = mostMs;
    this.#parts = firstParts;
  }

  /** For a view in motion: a late frame would be seen. */
  static moving(): PartPace {
    return new PartPace(1 / 4, () => 1, 4, 1);
  }

  /** For a view that draws the same again and again: parts shall come soon. */
  static still(): PartPace {
    return new PartPace(1, (parts) => parts, 8, 8);
  }

  get limit(): PartLimit {
    return { parts: this.#plainMs === undefined ? 1 : this.#parts, ms: this.#ms };
  }

  /**
   * Updates the limit after a frame.
   *
   * @param parts parts placed or removed since the previous frame.
   * @param frameMs from the frame's beginning until the device has finished it.
   * @param stepMs between the beginnings of the previous frame and this one.
   */
  addFrame(parts: number, frameMs: number, stepMs: number): void {
    const plainMs = this.#plainMs ?? frameMs;
    const delayMs = this.#delayShare * stepMs;
    this.#ms = Math.max(LEAST_MS, Math.min(this.#mostMs, delayMs));
    if (parts <= 1) this.#plainMs = plainMs + MEAN_WEIGHT * (frameMs - plainMs);
    if (parts === 0) this.#patience = 1;
    else if (frameMs > plainMs + delayMs) this.#slowDown(parts);
    else if (parts >= this.#parts && ++this.#inTime >= this.#patience) {
      this.#parts += this.#growthOf(this.#parts);
      this.#inTime = 0;
    }
  }

  #slowDown(parts: number): void {
    this.#parts = Math.max(1, Math.floor(Math.min(parts, this.#parts) / 2));
    this.#patience = Math.min(MOST_PATIENCE, 2 * this.#patience);
    this.#inTime = 0;
  }
}
