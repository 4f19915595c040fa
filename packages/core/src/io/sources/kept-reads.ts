import { onAbort } from '../../data/on-abort.ts';

interface Read<Part> {
  readonly arrival: Promise<Part>;
  readonly ending: AbortController;
  /** Number of waiting calls, then the size of the loaded part in bytes. */
  waiting: number;
  bytes: number;
}

/**
 * Cache of a source's numbered parts. Concurrent reads of a part share one load; the least recently
 * used parts are evicted.
 */
export class KeptReads<Part> {
  readonly #keptBytes: number;
  readonly #bytesOf: (part: Part) => number;
  /** By part number, most recently used last. */
  readonly #reads = new Map<number, Read<Part>>();

  /** @param keptBytes capacity for parts that no call waits for. */
  constructor(keptBytes: number, bytesOf: (part: Part) => number) {
    this.#keptBytes = keptBytes;
    this.#bytesOf = bytesOf;
  }

  /**
   * Reads a part. Rejects as `load`, and with the signal's reason.
   *
   * @param load loads the part if it is neither cached nor loading. Its signal aborts when no call
   *   waits for it any more.
   */
  async read(
    number: number,
    load: (signal: AbortSignal) => Promise<Part>,
    signal: AbortSignal | undefined,
  ): Promise<Part> {
    signal?.throwIfAborted();
    const read = this.#reads.get(number) ?? this.#begin(load);
    this.#reads.delete(number);
    this.#reads.set(number, read);
    read.waiting++;
    let ignoreSignal = () => {};
    const aborted = new Promise<never>((_, reject) => {
      ignoreSignal = onAbort(signal, () => reject(signal!.reason));
    });
    try {
      return await Promise.race([read.arrival, aborted]);
    } finally {
      ignoreSignal();
      if (--read.waiting === 0 && read.bytes === 0) this.#end(number, read);
      this.#dropOthers();
    }
  }

  /** Bytes of all kept parts. */
  get bytes(): number {
    return [...this.#reads.values()].reduce((sum, read) => sum + read.bytes, 0);
  }

  /** Loads a part again at its next read. */
  forget(number: number): void {
    this.#reads.delete(number);
  }

  #begin(load: (signal: AbortSignal) => Promise<Part>): Read<Part> {
    const ending = new AbortController();
    const read: Read<Part> = { arrival: load(ending.signal), ending, waiting: 0, bytes: 0 };
    read.arrival.then(
      (part) => {
        read.bytes = this.#bytesOf(part);
      },
      // The waiting calls report the error.
      () => {},
    );
    return read;
  }

  #end(number: number, read: Read<Part>): void {
    read.ending.abort();
    if (this.#reads.get(number) === read) this.#reads.delete(number);
  }

  #dropOthers(): void {
    let { bytes } = this;
    for (const [number, read] of this.#reads) {
      if (bytes <= this.#keptBytes) return;
      if (read.waiting > 0) continue;
      this.#reads.delete(number);
      bytes -= read.bytes;
    }
  }
}
