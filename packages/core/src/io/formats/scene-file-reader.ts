import { SplatFileError } from '../../data/errors.ts';
import { shown } from '../../data/printable.ts';
import { FewRequests } from '../sources/few-requests.ts';
import { isInnerPath } from '../sources/inner-path.ts';
import { checkSize, limitsOf } from '../sources/read-limits.ts';
import { openPart, readOpenedPart } from '../sources/read-part.ts';
import type { UncheckedBytes } from '../sources/splat-source.ts';
import type { SplatFormatOptions, SplatInput } from './read-format.ts';
import type { ReadProgress } from './rows/progress.ts';

/** The bytes of a file whose checksum is not yet verified. */
export interface UncheckedFile extends Pick<UncheckedBytes, 'bytes'> {
  /** Verifies the bytes. Rejects with SplatFileError 'damaged', or with the signal's reason. */
  check(): Promise<void>;
}

/**
 * Reads the other files of a scene, each at most once. Repeated references could otherwise make a
 * large scene of a few files.
 */
export class SceneFileReader {
  readonly #input: SplatInput;
  readonly #options: SplatFormatOptions;
  readonly #progress: ReadProgress;
  readonly #requests = new FewRequests();
  readonly #paths = new Set<string>();

  constructor(input: SplatInput, options: SplatFormatOptions, progress: ReadProgress) {
    this.#input = input;
    this.#options = options;
    this.#progress = progress;
  }

  /**
   * Reads a file. Rejects as `openPart` and `readPart`, and with SplatFileError 'damaged' if the
   * file was read before.
   *
   * @param path relative to the scene's folder.
   */
  async read(path: string): Promise<Uint8Array<ArrayBuffer>> {
    const { bytes, check } = await this.readUnchecked(path);
    await check();
    return bytes;
  }

  /** As `read`, but the checksums of archives are verified by `check` of the result. */
  async readUnchecked(path: string): Promise<UncheckedFile> {
    const { name } = this.#input;
    checkPath(path, name);
    if (this.#paths.has(path)) {
      const message = `it names the file ${path} twice. Export the scene again.`;
      throw new SplatFileError('damaged', name, message);
    }
    this.#paths.add(path);
    return this.#requests.run(() => this.#readFile(path), this.#options.signal);
  }

  async #readFile(path: string): Promise<UncheckedFile> {
    const opened = await openPart(this.#input, path, this.#options);
    const { unchecked } = opened;
    if (unchecked) {
      checkSize(opened, limitsOf(this.#options, opened).maxBytes);
      return { bytes: unchecked.bytes, check: () => unchecked.check(() => this.pause()) };
    }
    const begin = (totalBytes: number | undefined) => this.#progress.beginPart(totalBytes);
    return { bytes: await readOpenedPart(opened, this.#options, begin), check: async () => {} };
  }

  /** See `ReadProgress`. */
  expect(count: number): void {
    this.#progress.expectParts(count);
  }

  /** See `ByteReader`. */
  pause(): Promise<void> {
    return this.#input.reader.pause();
  }
}

/** @throws SplatFileError 'damaged' if a path leaves the scene's folder. */
export function checkPath(path: string, scene: string): void {
  if (isInnerPath(path)) return;
  const message = `it names a file "${shown(path)}", which may lie outside of its folder. Export the scene again.`;
  throw new SplatFileError('damaged', scene, message);
}
