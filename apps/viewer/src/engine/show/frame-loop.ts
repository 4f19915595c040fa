/** Frames in flight: one that the GPU draws and one ready to follow. More would only add delay. */
const MAX_FRAMES_IN_FLIGHT = 2;

export interface FrameLoopOptions {
  /**
   * Draws a frame, `elapsedMs` after the last. The promise resolves when the GPU has finished; null
   * if nothing was submitted.
   */
  readonly draw: (elapsedMs: number) => Promise<unknown> | null;
  /** A frame has been drawn. */
  readonly onDrawn: (completedMs: number) => void;
  /** Every requested frame has been drawn; no callback is pending until the next request. */
  readonly onIdle: () => void;
}

/** Calls `draw` once per display refresh while frames are requested, never without a request. */
export class FrameLoop {
  readonly #options: FrameLoopOptions;
  #handle = 0;
  #framesInFlight = 0;
  #isWanted = false;
  #lastMs: number | null = null;

  constructor(options: FrameLoopOptions) {
    this.#options = options;
  }

  request(): void {
    this.#isWanted = true;
    if (this.#handle === 0 && this.#framesInFlight < MAX_FRAMES_IN_FLIGHT) {
      this.#handle = requestAnimationFrame((nowMs) => this.#run(nowMs));
    }
  }

  /** Whether no frame is requested and none is in flight. */
  get isResting(): boolean {
    return this.#handle === 0 && this.#framesInFlight === 0 && !this.#isWanted;
  }

  stop(): void {
    cancelAnimationFrame(this.#handle);
    this.#handle = 0;
    this.#isWanted = false;
  }

  #run(nowMs: number): void {
    this.#handle = 0;
    this.#isWanted = false;
    const elapsedMs = this.#lastMs === null ? NOMINAL_FRAME_MS : nowMs - this.#lastMs;
    this.#lastMs = nowMs;
    const completion = this.#options.draw(elapsedMs);
    if (!completion) {
      this.#settle();
      return;
    }
    this.#framesInFlight++;
    const done = () => {
      this.#framesInFlight--;
      this.#options.onDrawn(performance.now());
      if (this.#isWanted) this.request();
      this.#settle();
    };
    // A lost device rejects; the session's owner reports that.
    completion.then(done, done);
  }

  #settle(): void {
    if (this.#isWanted || this.#framesInFlight > 0) return;
    // The pause until the next request is not part of any movement.
    this.#lastMs = null;
    this.#options.onIdle();
  }
}

/** Elapsed time passed to the first frame after a pause. */
const NOMINAL_FRAME_MS = 1000 / 60;
