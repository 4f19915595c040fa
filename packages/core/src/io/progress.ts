import type { LoadProgress } from './splat-source.ts';

/** Shortest time between two reports. */
const REPORT_EVERY_MS = 30;

/** Passes a reader's progress on, not more often than a person can see. */
export class ReadProgress {
  readonly #totalBytes: number | undefined;
  readonly #onProgress: ((progress: LoadProgress) => void) | undefined;
  #lastReportMs = Number.NEGATIVE_INFINITY;

  constructor(totalBytes: number | undefined, onProgress: ((progress: LoadProgress) => void) | undefined) {
    this.#totalBytes = totalBytes;
    this.#onProgress = onProgress;
  }

  report(loadedBytes: number, splats: number): void {
    if (this.#onProgress && performance.now() - this.#lastReportMs >= REPORT_EVERY_MS)
      this.finish(loadedBytes, splats);
  }

  /** As `report`, but in any case. */
  finish(loadedBytes: number, splats: number): void {
    this.#lastReportMs = performance.now();
    // A size that has been passed was that of the compressed bytes.
    const known = this.#totalBytes !== undefined && loadedBytes <= this.#totalBytes;
    this.#onProgress?.({
      phase: 'read',
      loadedBytes,
      totalBytes: known ? this.#totalBytes : undefined,
      splats,
    });
  }
}
