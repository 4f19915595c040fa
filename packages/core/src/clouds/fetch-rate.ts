/** Time over which bytes per second are counted. */
const WINDOW_MS = 2000;

/** Bytes per second of the last two seconds, or of those since fetching began. */
export class FetchRate {
  /** Those of the window, oldest first. */
  #arrivals: readonly { readonly atMs: number; readonly bytes: number }[] = [];
  #beganMs = 0;

  /** Fetching begins, after nothing was being fetched. */
  begin(): void {
    this.#beganMs = performance.now();
  }

  take(bytes: number): void {
    const atMs = performance.now();
    const recent = this.#arrivals.filter((each) => each.atMs > atMs - WINDOW_MS);
    this.#arrivals = [...recent, { atMs, bytes }];
  }

  get bytesPerSecond(): number {
    const nowMs = performance.now();
    const sinceMs = Math.max(this.#beganMs, nowMs - WINDOW_MS);
    const bytes = this.#arrivals.reduce((sum, each) => sum + (each.atMs >= sinceMs ? each.bytes : 0), 0);
    return nowMs > sinceMs ? (1000 * bytes) / (nowMs - sinceMs) : 0;
  }
}
