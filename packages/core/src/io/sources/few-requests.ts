import { onAbort } from '../../data/on-abort.ts';

/** Requests of one scene that are under way at once, whatever its files or its server say. */
export const MOST_REQUESTS = 8;

/** Starts requests of one scene in the order in which they are asked for, a few at once. */
export class FewRequests {
  readonly #most: number;
  #underWay = 0;
  /** Starts of requests that wait for others to end. */
  readonly #waiting = new Set<() => void>();

  constructor(most = MOST_REQUESTS) {
    this.#most = most;
  }

  /**
   * Runs `request` once there are few enough others; it ends when its answer has been read.
   *
   * Rejects as `request`, and with the signal's reason if that aborts before it is its turn.
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

  /** Resolves with the place of a request that has ended. */
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
