/** Runs pieces of work one by one, in the order of requests, each when the page is idle. */
export class Turns {
  readonly #whenIdle: () => Promise<void>;
  #last: Promise<unknown> = Promise.resolve();

  /** @param whenIdle resolves when the page has time; for tests. */
  constructor(whenIdle = pageIsIdle) {
    this.#whenIdle = whenIdle;
  }

  /** Settles as `work` does. Rejects with the reason of `signal` if that aborts before its turn. */
  take<Result>(work: () => Promise<Result>, signal: AbortSignal): Promise<Result> {
    const turn = this.#last.then(async () => {
      signal.throwIfAborted();
      await this.#whenIdle();
      signal.throwIfAborted();
      return work();
    });
    // The next in turn follows both success and failure.
    this.#last = turn.catch(() => {});
    return turn;
  }
}

/** A page that never rests still gets its work done. */
const LONGEST_WAIT_MS = 500;

function pageIsIdle(): Promise<void> {
  return new Promise((resolve) => {
    // Safari has none.
    if (typeof requestIdleCallback === 'function')
      requestIdleCallback(() => resolve(), { timeout: LONGEST_WAIT_MS });
    else setTimeout(resolve);
  });
}
