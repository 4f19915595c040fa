import { MOST_REQUEST_BYTES } from '../../data/bricks/brick-files.ts';
import { onAbort } from '../../data/on-abort.ts';
import { type ByteRange, endOf } from './remote-file.ts';

/** A read that waits for its part. */
interface WaitingRead<Part, Result> {
  readonly part: Part;
  readonly resolve: (result: Result) => void;
  readonly reject: (reason: unknown) => void;
}

/**
 * Reads a run of adjacent parts by one request, and resolves each read as soon as its part is there.
 * Rejects if some reads were not settled.
 *
 * @param signal aborts once no caller waits for any part.
 */
export type ReadRun<Part extends ByteRange, Result> = (
  run: readonly WaitingRead<Part, Result>[],
  signal: AbortSignal,
) => Promise<void>;

interface AskedRead<Part, Result> extends WaitingRead<Part, Result> {
  readonly signal: AbortSignal | undefined;
}

/** Joins reads of adjacent parts of a file that are made in the same turn. */
export class AdjacentReads<Part extends ByteRange, Result> {
  readonly #readRun: ReadRun<Part, Result>;
  /** Reads of the current turn, not yet requested. */
  #asked: AskedRead<Part, Result>[] = [];

  constructor(readRun: ReadRun<Part, Result>) {
    this.#readRun = readRun;
  }

  /** Rejects as `ReadRun`, and with the signal's reason. */
  read(part: Part, signal?: AbortSignal): Promise<Result> {
    return new Promise((resolve, reject) => {
      if (this.#asked.length === 0) queueMicrotask(() => this.#send());
      this.#asked.push({ part, signal, resolve, reject });
    });
  }

  /** Sends one request for each run of adjacent parts. */
  #send(): void {
    const asked = this.#asked.sort((a, b) => a.part.offset - b.part.offset);
    this.#asked = [];
    let run: AskedRead<Part, Result>[] = [];
    for (const [i, read] of asked.entries()) {
      run.push(read);
      const next = asked[i + 1]?.part;
      const isAdjacent = next?.offset === endOf(read.part);
      if (isAdjacent && endOf(next) - run[0].part.offset <= MOST_REQUEST_BYTES) continue;
      void this.#sendRun(run);
      run = [];
    }
  }

  async #sendRun(run: readonly AskedRead<Part, Result>[]): Promise<void> {
    const ending = new AbortController();
    const reads = run.map(({ part, resolve, reject }) => {
      const read: WaitingRead<Part, Result> = {
        part,
        resolve: (result) => {
          waiting.delete(read);
          resolve(result);
        },
        reject: (reason) => {
          waiting.delete(read);
          reject(reason);
        },
      };
      return read;
    });
    const waiting = new Set(reads);
    const ignoreSignals = run.map(({ signal }, i) => {
      const leave = () => {
        reads[i].reject(signal!.reason);
        if (waiting.size === 0) ending.abort(signal!.reason);
      };
      if (signal?.aborted) leave();
      return onAbort(signal, leave);
    });
    try {
      await this.#readRun(reads, ending.signal);
    } catch (error) {
      for (const { reject } of waiting) reject(error);
    } finally {
      for (const ignore of ignoreSignals) ignore();
    }
  }
}
