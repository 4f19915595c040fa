import { onAbort } from '../../data/on-abort.ts';

/** Most parallel requests per scene, independent of its files and its server. */
export const MOST_REQUESTS = 8;

/** Queue of one scene's requests: first in, first out, a few in parallel. */
export class FewRequests {
  readonly #most: number;
  #underWay = 0;
  /** Resolvers of queued requests. */
  readonly #waiting = new Set<() => void>();

  constructor(most = MOST_REQUESTS) {
    this.#most = most;
  }

  /**
   * Runs `request` once a slot is free; it must resolve only after its response was read.
   *
   * Rejects as `request`, and with the signal's reason if it aborts in the queue.
   */
  async run<Result>(request: () => Promise<Result>, signal: AbortSignal | undefined): Promise<Result> {
    if (this.#underWay >= this.#most) await this.#turn(signal);
    else this.#underWay++;
    try {
      signal?.throwIfAborted();
      return await request();
    } finally {
      this.#giveOn();
    }
  }

  /** Resolves with the slot of a finished request. */
  #turn(signal: AbortSignal | undefined): Promise<void> {
    return new Promise((resolve, reject) => {
      if (signal?.aborted) return reject(signal.reason);
      const start = () => {
        ignoreSignal();
        resolve();
      };
      const ignoreSignal = onAbort(signal, () => {
        this.#waiting.delete(start);
        reject(signal!.reason);
      });
      this.#waiting.add(start);
    });
  }

  #giveOn(): void {
    const [next] = this.#waiting;
    if (next === undefined) {
      this.#underWay--;
      return;
    }
    this.#waiting.delete(next);
    next();
  }
}
