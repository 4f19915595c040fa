import { open, statfs, unlink } from 'node:fs/promises';
import type { MakeTemporaryFile, TemporaryFile } from '@websplatter/core/write';
import { describeSystemError, InputFileError } from './input-error.ts';
import { partPath } from './part-names.ts';

/** A folder for data that does not fit the memory. */
export class TemporaryFolder {
  readonly #path: string;

  constructor(path: string) {
    this.#path = path;
  }

  /**
   * Makes a file without a name (already unlinked), so that the system removes it however this process
   * ends.
   *
   * Rejects with InputFileError if the folder does not exist or has no room for `byteCount` bytes.
   */
  readonly makeFile: MakeTemporaryFile = async (byteCount) => {
    if (byteCount !== undefined) await this.checkRoom(byteCount);
    const path = partPath(this.#path);
    try {
      const file = await open(path, 'wx+', 0o600);
      await unlink(path);
      const place: TemporaryFile = {
        write: async (bytes, at) => {
          try {
            for (let from = 0; from < bytes.length; ) {
              const { bytesWritten } = await file.write(bytes, from, bytes.length - from, at + from);
              from += bytesWritten;
            }
          } catch (error) {
            throw this.#error(error);
          }
        },
        read: async (at, count) => {
          const bytes = new Uint8Array(count);
          for (let from = 0; from < count; ) {
            const { bytesRead } = await file.read(bytes, from, count - from, at + from);
            if (bytesRead === 0) throw this.#error(new Error('a temporary file is shorter than it was'));
            from += bytesRead;
          }
          return bytes;
        },
        remove: () => file.close(),
      };
      return place;
    } catch (error) {
      throw this.#error(error);
    }
  };

  /** Rejects with InputFileError where there is no room for so many bytes. */
  async checkRoom(byteCount: number): Promise<void> {
    const { bavail, bsize } = await statfs(this.#path).catch((error) => {
      throw this.#error(error);
    });
    const free = bavail * bsize;
    if (free < byteCount)
      throw new InputFileError(
        this.#path,
        `has ${inGigabytes(free)} GB free, and temporary data take ${inGigabytes(byteCount)} GB; make room, or name another folder by --temp`,
      );
  }

  #error(error: unknown): InputFileError {
    const isFull = (error as NodeJS.ErrnoException).code === 'ENOSPC';
    const detail = isFull ? 'it is full' : describeSystemError(error);
    const message = `cannot take temporary data: ${detail}; make room, or name another folder by --temp`;
    return new InputFileError(this.#path, message, undefined, { cause: error });
  }
}

function inGigabytes(byteCount: number): string {
  return (byteCount / 1e9).toFixed(1);
}
