import type { LoadProgress } from '../sources/splat-source.ts';

/** Shortest time between two reports. */
const REPORT_EVERY_MS = 30;

/** Passes on a reader's progress, no more often than a person can see. */
export class ReadProgress {
  readonly #totalBytes: number | undefined;
  readonly #onProgress: ((progress: LoadProgress) => void) | undefined;
  readonly #startMs = performance.now();
  #lastReportMs = Number.NEGATIVE_INFINITY;

  constructor(totalBytes: number | undefined, onProgress: ((progress: LoadProgress) => void) | undefined) {
    this.#totalBytes = totalBytes;
    this.#onProgress = onProgress;
  }

  report(loadedBytes: number, splats: number): void {
    if (this.#onProgress && performance.now() - this.#lastReportMs >= REPORT_EVERY_MS)
      this.finish(loadedBytes, splats);
  }

  /** As `report`, but always. */
  finish(loadedBytes: number, splats: number): void {
    this.#lastReportMs = performance.now();
    const elapsedMs = this.#lastReportMs - this.#startMs;
    // A stated size that has been exceeded was that of the compressed bytes.
    const known = this.#totalBytes !== undefined && loadedBytes <= this.#totalBytes;
    this.#onProgress?.({
      phase: 'read',
      loadedBytes,
      totalBytes: known ? this.#totalBytes : undefined,
      splats,
      bytesPerSecond: elapsedMs > 0 ? (1000 * loadedBytes) / elapsedMs : 0,
    });
  }
}
