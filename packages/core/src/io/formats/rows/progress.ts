import type { LoadProgress } from '../../sources/splat-source.ts';
import type { SplatInput } from '../read-format.ts';

/** Least time between two reports. */
const REPORT_EVERY_MS = 30;

/** Another file of a scene. */
interface Part {
  /** Undefined if unknown. */
  readonly totalBytes: number | undefined;
  loadedBytes: number;
}

/**
 * Throttles progress reports of a reader. For a scene with several files, the total is reported
 * only once all sizes are known: a growing total would make the bar go backwards.
 */
export class ReadProgress {
  readonly #input: SplatInput;
  readonly #onProgress: ((progress: LoadProgress) => void) | undefined;
  #lastReportMs = Number.NEGATIVE_INFINITY;
  readonly #parts: Part[] = [];
  #expectedParts: number | undefined;

  constructor(input: SplatInput, onProgress: ((progress: LoadProgress) => void) | undefined) {
    this.#input = input;
    this.#onProgress = onProgress;
  }

  /** Sets the number of further files of the scene. */
  expectParts(count: number): void {
    this.#expectedParts = count;
  }

  /**
   * Counts another file of the scene as it arrives.
   *
   * @param totalBytes its size; undefined if unknown.
   * @returns a function to call with the number of bytes that have arrived.
   */
  beginPart(totalBytes: number | undefined): (loadedBytes: number) => void {
    // The packed input already counts these bytes.
    if (this.#input.packed) return () => {};
    const part: Part = { totalBytes, loadedBytes: 0 };
    this.#parts.push(part);
    return (loadedBytes) => {
      part.loadedBytes = loadedBytes;
      this.report(0);
    };
  }

  /** Reports bytes that arrive before there are rows. */
  readonly arrived = (): void => this.report(0);

  report(splats: number): void {
    if (this.#onProgress && performance.now() - this.#lastReportMs >= REPORT_EVERY_MS) this.finish(splats);
  }

  /** As `report`, but not throttled. */
  finish(splats: number): void {
    // Packed input counts compressed bytes as they arrive.
    const { reader } = this.#input.packed ?? this.#input;
    const loadedBytes = this.#parts.reduce((sum, part) => sum + part.loadedBytes, reader.byteOffset);
    const totalBytes = this.#totalBytes();
    this.#lastReportMs = performance.now();
    const elapsedMs = this.#lastReportMs - reader.openedMs;
    // More bytes than stated arrived: the stated size was the compressed one.
    const known = totalBytes !== undefined && loadedBytes <= totalBytes;
    this.#onProgress?.({
      phase: 'read',
      loadedBytes,
      totalBytes: known ? totalBytes : undefined,
      splats,
      bytesPerSecond: elapsedMs > 0 ? (1000 * loadedBytes) / elapsedMs : 0,
    });
  }

  #totalBytes(): number | undefined {
    const { packed, reader, totalBytes } = this.#input;
    if (packed) return packed.totalBytes;
    if (this.#parts.length === 0 && this.#expectedParts === undefined) return totalBytes;
    if (this.#parts.length !== this.#expectedParts) return undefined;
    return this.#parts.reduce<number | undefined>(
      (sum, part) => (sum === undefined || part.totalBytes === undefined ? undefined : sum + part.totalBytes),
      reader.byteOffset,
    );
  }
}
