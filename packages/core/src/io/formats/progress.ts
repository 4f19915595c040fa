import type { LoadProgress } from '../sources/splat-source.ts';
import type { SplatInput } from './splat-format.ts';

/** Shortest time between two reports. */
const REPORT_EVERY_MS = 30;

/** Passes on a reader's progress, no more often than a person can see. */
export class ReadProgress {
  readonly #input: SplatInput;
  readonly #onProgress: ((progress: LoadProgress) => void) | undefined;
  readonly #startMs = performance.now();
  #lastReportMs = Number.NEGATIVE_INFINITY;
  #partBytes = 0;

  constructor(input: SplatInput, onProgress: ((progress: LoadProgress) => void) | undefined) {
    this.#input = input;
    this.#onProgress = onProgress;
  }

  /** Counts another file of the scene, which has been read. */
  addPart(bytes: number): void {
    // What is packed has them in it.
    if (this.#input.packed) return;
    this.#partBytes += bytes;
    this.report(0);
  }

  report(splats: number): void {
    if (this.#onProgress && performance.now() - this.#lastReportMs >= REPORT_EVERY_MS) this.finish(splats);
  }

  /** As `report`, but always. */
  finish(splats: number): void {
    // What is packed is counted as it arrives.
    const { totalBytes, reader } = this.#input.packed ?? this.#input;
    const loadedBytes = reader.byteOffset + this.#partBytes;
    this.#lastReportMs = performance.now();
    const elapsedMs = this.#lastReportMs - this.#startMs;
    // A stated size that has been exceeded was that of the compressed bytes, or of the first file of several.
    const known = totalBytes !== undefined && loadedBytes <= totalBytes;
    this.#onProgress?.({
      phase: 'read',
      loadedBytes,
      totalBytes: known ? totalBytes : undefined,
      splats,
      bytesPerSecond: elapsedMs > 0 ? (1000 * loadedBytes) / elapsedMs : 0,
    });
  }
}
