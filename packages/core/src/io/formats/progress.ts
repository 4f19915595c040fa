import type { LoadProgress } from '../sources/splat-source.ts';
import type { SplatInput } from './read-format.ts';

/** Shortest time between two reports. */
const REPORT_EVERY_MS = 30;

/** Another file of a scene. */
interface Part {
  /** Undefined if it is not known. */
  readonly totalBytes: number | undefined;
  loadedBytes: number;
}

/**
 * Passes on a reader's progress, no more often than a person can see. Of a scene with several
 * files, the first of which has been read, the size is told from when it is known of all of them: a
 * size that grew would make the part that is done shrink.
 */
export class ReadProgress {
  readonly #input: SplatInput;
  readonly #onProgress: ((progress: LoadProgress) => void) | undefined;
  readonly #startMs = performance.now();
  #lastReportMs = Number.NEGATIVE_INFINITY;
  readonly #parts: Part[] = [];
  #expectedParts: number | undefined;

  constructor(input: SplatInput, onProgress: ((progress: LoadProgress) => void) | undefined) {
    this.#input = input;
    this.#onProgress = onProgress;
  }

  /** Says how many other files the scene has that will be read. */
  expectParts(count: number): void {
    this.#expectedParts = count;
  }

  /**
   * Counts another file of the scene, as it arrives.
   *
   * @param totalBytes its size; undefined if that is not known.
   * @returns to be told how many bytes of it are there.
   */
  beginPart(totalBytes: number | undefined): (loadedBytes: number) => void {
    // The packed file counts them.
    if (this.#input.packed) return () => {};
    const part: Part = { totalBytes, loadedBytes: 0 };
    this.#parts.push(part);
    return (loadedBytes) => {
      part.loadedBytes = loadedBytes;
      this.report(0);
    };
  }

  report(splats: number): void {
    if (this.#onProgress && performance.now() - this.#lastReportMs >= REPORT_EVERY_MS) this.finish(splats);
  }

  /** As `report`, but always. */
  finish(splats: number): void {
    // Packed files count as they arrive.
    const { reader } = this.#input.packed ?? this.#input;
    const loadedBytes = this.#parts.reduce((sum, part) => sum + part.loadedBytes, reader.byteOffset);
    const totalBytes = this.#totalBytes();
    this.#lastReportMs = performance.now();
    const elapsedMs = this.#lastReportMs - this.#startMs;
    // A stated size that has been exceeded counted the compressed bytes.
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
