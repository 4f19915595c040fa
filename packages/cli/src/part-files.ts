import { closeSync, openSync, rmSync } from 'node:fs';
import { type FileHandle, open, rename, rm } from 'node:fs/promises';
import { dirname } from 'node:path';
import type { OutputPlace } from './output-place.ts';
import { partPath } from './part-names.ts';

const SIGNALS: readonly NodeJS.Signals[] = ['SIGINT', 'SIGTERM', 'SIGHUP'];

/**
 * Temporary files beside their destinations. Incomplete ones are removed when the process ends, also
 * by a signal.
 */
export class PartFiles {
  /** Temporary path by destination path. */
  readonly #parts = new Map<string, string>();
  readonly #remove = () => {
    for (const part of this.#parts.values()) rmSync(part, { force: true });
    this.#parts.clear();
  };
  readonly #onSignal = (signal: NodeJS.Signals) => {
    this.end();
    // The signal sets status 128 + number; `process.exit` would wait for a pipe without a reader.
    process.kill(process.pid, signal);
  };

  constructor() {
    process.once('exit', this.#remove);
    for (const signal of SIGNALS) process.once(signal, this.#onSignal);
  }

  /**
   * Makes the file that will replace the one at `place`, with its mode and owner; null where that
   * is not permitted, so that the older one can only be written into.
   *
   * Rejects with the system's error.
   */
  async open({ path, found }: OutputPlace): Promise<FileHandle | null> {
    const part = partPath(dirname(path));
    let file: FileHandle | undefined;
    try {
      makeFile(part, found && 0o600);
      this.#parts.set(path, part);
      file = await open(part, 'r+');
      if (found) {
        const { uid, gid } = await file.stat();
        if (uid !== Number(found.uid) || gid !== Number(found.gid))
          await file.chown(Number(found.uid), Number(found.gid));
        await file.chmod(Number(found.mode) & 0o7777);
      }
      return file;
    } catch (error) {
      await file?.close();
      if (!found || !isForbidden(error)) throw error;
      if (this.#parts.delete(path)) await rm(part, { force: true });
      return null;
    }
  }

  /** Renames the temporary file to its destination. */
  async finish({ path }: OutputPlace): Promise<void> {
    await rename(this.#parts.get(path)!, path);
    this.#parts.delete(path);
  }

  /** Removes the temporary files that have not been renamed. */
  end(): void {
    process.off('exit', this.#remove);
    for (const signal of SIGNALS) process.off(signal, this.#onSignal);
    this.#remove();
  }
}

/** Whether an error of the system says that something is not permitted. */
export function isForbidden(error: unknown): boolean {
  return ['EACCES', 'EPERM'].includes((error as NodeJS.ErrnoException).code ?? '');
}

/**
 * Makes and removes a file in `folder`, to see whether results can be put there.
 *
 * @throws the system's error.
 */
export function tryPart(folder: string): void {
  const part = partPath(folder);
  makeFile(part);
  rmSync(part, { force: true });
}

/** Makes an empty file. No signal is handled before this returns, so that the file is known to its maker. */
function makeFile(path: string, mode?: number): void {
  closeSync(openSync(path, 'wx', mode));
}
