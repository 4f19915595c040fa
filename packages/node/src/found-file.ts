import type { BigIntStats } from 'node:fs';
import { type FileHandle, open, stat } from 'node:fs/promises';
import { basename } from 'node:path';
import { ReadableStream as WebStream } from 'node:stream/web';
import { SplatSourceError } from '@websplatter/core';

/** Bytes that are read from a file at once. */
const READ_BYTES = 1 << 20;

/** A file that must not change after it was found: it is opened and checked for each reading. */
export class FoundFile {
  readonly path: string;
  readonly #found: BigIntStats;
  readonly #onRead: () => void;

  /**
   * @param found result of `stat` with `bigint`.
   * @param onRead called whenever the file is about to be read.
   */
  constructor(path: string, found: BigIntStats, onRead: () => void = () => {}) {
    this.path = path;
    this.#found = found;
    this.#onRead = onRead;
  }

  /** In bytes. */
  get size(): number {
    return Number(this.#found.size);
  }

  /** The parts of a File that readers need. */
  asBlob(): Blob {
    const stream = () => webStreamOf(this.contents());
    const slice = (start = 0, end = this.size) => this.part(start, Math.min(end, this.size));
    return { name: basename(this.path), size: this.size, stream, slice } as unknown as Blob;
  }

  /** All bytes. Rejects with SplatSourceError if they change before all are read. */
  async *contents(): AsyncGenerator<Uint8Array<ArrayBuffer>> {
    this.#onRead();
    const file = await this.#open();
    try {
      await this.#check(file);
      yield* file.createReadStream({ highWaterMark: READ_BYTES, autoClose: false });
      await this.#check(file);
    } finally {
      await file.close();
    }
  }

  /** Bytes `start` to `end`, which reject with SplatSourceError if the file has changed. */
  part(start: number, end: number): Blob {
    const size = Math.max(0, end - start);
    const arrayBuffer = async () => {
      const file = await this.#open();
      try {
        const bytes = new Uint8Array(size);
        const { bytesRead } = await file.read(bytes, 0, size, start);
        await this.#check(file);
        return bytes.buffer.slice(0, bytesRead);
      } finally {
        await file.close();
      }
    };
    return { size, arrayBuffer } as unknown as Blob;
  }

  async #open(): Promise<FileHandle> {
    return open(this.path).catch((error) => {
      throw error.code === 'ENOENT' ? this.#changedError() : error;
    });
  }

  async #check(file: FileHandle): Promise<void> {
    const now = await file.stat({ bigint: true });
    const facts = ['dev', 'ino', 'size', 'mtimeNs'] as const;
    if (facts.some((fact) => now[fact] !== this.#found[fact])) throw this.#changedError();
  }

  #changedError(): SplatSourceError {
    return new SplatSourceError(this.path, 'it changed while it was read; try again once nothing writes it');
  }
}

/** The file at a path as it is now. Rejects with the system's error. */
export async function findFile(path: string, onRead?: () => void): Promise<FoundFile> {
  return new FoundFile(path, await stat(path, { bigint: true }), onRead);
}

/** `Readable.toWeb` gives a stream that throws outside of every promise if cancelled while full. */
export function webStreamOf(chunks: AsyncIterable<Uint8Array>): ReadableStream<Uint8Array<ArrayBuffer>> {
  return WebStream.from(chunks) as ReadableStream<Uint8Array<ArrayBuffer>>;
}
