import type { FrameRate } from '../state/viewer-state.ts';

/** The mean covers this many frames. */
const WINDOW_FRAMES = 30;
/** A longer mean would lag behind what people feel. */
const WINDOW_MS = 1000;

/**
 * Measures the pace of frames that are drawn only on demand: the pause between two runs is not a
 * slow frame. All times are in milliseconds of one clock.
 */
export class FrameMeter {
  #completedMs: number[] = [];

  /** The last frame has been drawn and no other is requested: the next one starts a new run. */
  pause(): void {
    this.#completedMs = [];
  }

  /** A frame was drawn at `completedMs`. Returns null for the first of a run, without a pace. */
  add(completedMs: number): FrameRate | null {
    const times = this.#completedMs;
    times.push(completedMs);
    // Two frames are kept however slow they are.
    while (times.length > 2 && (times.length > WINDOW_FRAMES + 1 || completedMs - times[0] > WINDOW_MS)) {
      times.shift();
    }
    const frameMs = (completedMs - times[0]) / (times.length - 1);
    return frameMs > 0 ? { frameMs, framesPerSecond: 1000 / frameMs } : null;
  }
}
