import { onAbort } from '../../data/on-abort.ts';

interface Read<Part> {
  readonly arrival: Promise<Part>;
  readonly ending: AbortController;
  /** Calls that wait for it, and the bytes of what has come. */
  waiting: number;
  bytes: number;
}

/** Reads numbered parts of a source, each once for all calls that wait for it, and keeps the last ones. */
export class KeptReads<Part> {
  readonly #keptBytes: number;
  readonly #bytesOf: (part: Part) => number;
  /** By number, the one that was used last behind the others. */
  readonly #reads = new Map<number, Read<Part>>();

  /** @param keptBytes of parts that no call waits for. */
  constructor(keptBytes: number, bytesOf: (part: Part) => number) {
    this.#keptBytes = keptBytes;
    this.#bytesOf = bytesOf;
  }

  /**
   * Rejects as `load`, and with the signal's reason.
   *
   * @param load reads the part, if it is not there and no other call waits for it; its signal aborts
   *   when none does any more.
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

  #begin(load: (signal: AbortSignal) => Promise<Part>): Read<Part> {
    const ending = new AbortController();
    const read: Read<Part> = { arrival: load(ending.signal), ending, waiting: 0, bytes: 0 };
    read.arrival.then(
      (part) => {
        read.bytes = this.#bytesOf(part);
      },
      // Calls that wait for it are told.
      () => {},
    );
    return read;
  }

  #end(number: number, read: Read<Part>): void {
    read.ending.abort();
    if (this.#reads.get(number) === read) this.#reads.delete(number);
  }

  #dropOthers(): void {
    let bytes = [...this.#reads.values()].reduce((sum, read) => sum + read.bytes, 0);
    for (const [number, read] of this.#reads) {
      if (bytes <= this.#keptBytes) return;
      if (read.waiting > 0) continue;
      this.#reads.delete(number);
      bytes -= read.bytes;
    }
  }
}
