import type { ViewerState, ViewerStore } from '../../state/store.ts';
import { summarize } from '../../state/time-summary.ts';

/** Frames with all splats that take longer than this are too slow for moving the camera, ms. */
const SLOW_FROM_MS = 50;
/** Below this, frames count as quick again, ms; between both limits nothing changes. */
const QUICK_BELOW_MS = 25;
/** The median of this many frames is judged: one slow frame says nothing. */
const JUDGED_FRAMES = 3;
/** Frames less than this apart, besides their own duration, are in motion, ms. */
const RESTS_AFTER_MS = 250;

/** Detects slow devices by the times of frames that draw all splats. */
export class WholeFrames {
  #timesMs: readonly number[] = [];
  #slowMs: number | null = null;

  /** Median time of a frame with all splats if it is slow; null if it is fast or unknown. */
  get slowMs(): number | null {
    return this.#slowMs;
  }

  add(elapsedMs: number): void {
    this.#timesMs = [...this.#timesMs, elapsedMs].slice(-JUDGED_FRAMES);
    if (this.#timesMs.length < JUDGED_FRAMES) return;
    const { median } = summarize(this.#timesMs);
    if (median > SLOW_FROM_MS) this.#slowMs = median;
    else if (median < QUICK_BELOW_MS) this.#slowMs = null;
  }
}

/**
 * Writes `wholeFrameMs` to the store, for one scene after the other.
 *
 * @param hasLevels whether the scene can be drawn with fewer splats.
 */
export function observeWholeFrames(store: ViewerStore, hasLevels: () => boolean): void {
  let frames = new WholeFrames();
  let measuredMs = Number.NEGATIVE_INFINITY;
  store.subscribe((state, before) => {
    const isNew = state.scene !== before.scene;
    if (!isNew && state.statistics === before.statistics) return;
    const nowMs = performance.now();
    if (isNew || !hasLevels()) frames = new WholeFrames();
    else if (isWhole(state)) {
      const { totalMs } = state.statistics!.timing;
      const sinceLastMs = nowMs - measuredMs;
      // At rest a frame waits for none. In motion the clock counts the wait for the one before, too.
      if (frames.slowMs !== null) frames.add(totalMs);
      else if (sinceLastMs < totalMs + RESTS_AFTER_MS) frames.add(Math.min(totalMs, sinceLastMs));
    }
    measuredMs = nowMs;
    if (frames.slowMs !== state.wholeFrameMs) store.setState({ wholeFrameMs: frames.slowMs });
  });
}

/** Not parts of a file, nor of two pictures at once, nor with fewer splats. */
function isWhole({ load, comparison, statistics }: ViewerState): boolean {
  return !load && comparison?.kind !== 'split' && statistics?.cutErrorPx === null;
}
