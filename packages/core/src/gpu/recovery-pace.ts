/** How long to wait before the first, second, … attempt in a row to get a GPU again. */
const WAITS_MS = [0, 1000, 4000, 16_000];
/** A device that lasts this long in use has recovered: its loss is the first in a row. */
const RECOVERED_AFTER_MS = 60_000;

/**
 * Paces attempts to get a GPU again after the device was lost: at once, then after 1, 4 and 16
 * seconds, and then no more. Causes of a loss that recur, such as a scene too large for the GPU's
 * memory, must not do so for ever; and a browser may have no adapter while its GPU process
 * restarts.
 *
 * @example
 * const pace = new RecoveryPace();
 * async function recover(): Promise<SplatEngine | null> {
 *   const waitMs = pace.next();
 *   if (waitMs === null) return null; // Offer a button instead.
 *   await new Promise((resolve) => setTimeout(resolve, waitMs));
 *   return SplatEngine.create().catch(recover);
 * }
 * // Load the scene on the next engine; call `pace.recovered()` once it is drawn.
 * const next = await engine.lost.then(recover);
 */
export class RecoveryPace {
  #attempts = 0;
  #recoveredMs = Number.POSITIVE_INFINITY;

  /**
   * Call when the device was lost, and when an attempt to get another has failed.
   *
   * @param nowMs present time on any clock, ms.
   * @returns how long to wait before the next attempt, ms; null after the last attempt: offer a
   *   button that retries with a new `RecoveryPace`.
   */
  next(nowMs = performance.now()): number | null {
    if (nowMs - this.#recoveredMs > RECOVERED_AFTER_MS) this.#attempts = 0;
    this.#recoveredMs = Number.POSITIVE_INFINITY;
    return WAITS_MS[this.#attempts++] ?? null;
  }

  /**
   * Call when everything is on the screen again; further calls change nothing. If the device lasts
   * for a minute after this call, its next loss counts as the first. The time before, in which a
   * device is requested and files are read and uploaded, does not count: the cause of the loss may
   * recur only once all files are uploaded.
   *
   * @param nowMs present time on the same clock, ms.
   */
  recovered(nowMs = performance.now()): void {
    this.#recoveredMs = Math.min(this.#recoveredMs, nowMs);
  }
}
