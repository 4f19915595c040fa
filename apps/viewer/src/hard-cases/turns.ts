/** Runs tasks one at a time, in the order of requests, each when the page is idle. */
export class Turns {
  readonly #whenIdle: () => Promise<void>;
  #last: Promise<unknown> = Promise.resolve();

  /** @param whenIdle resolves when the page has time; for tests. */
  constructor(whenIdle = pageIsIdle) {
    this.#whenIdle = whenIdle;
  }

  /**
   * Settles as `work` does. Rejects with the reason of `signal` if it aborts before the task
   * starts.
   */
  take<Result>(work: () => Promise<Result>, signal: AbortSignal): Promise<Result> {
    const turn = this.#last.then(async () => {
      signal.throwIfAborted();
      await this.#whenIdle();
      signal.throwIfAborted();
      return work();
    });
    // The next task follows success and failure alike.
    this.#last = turn.catch(() => {});
    return turn;
  }
}

/** Longest wait for an idle page, ms: a busy page gets its work done too. */
const LONGEST_WAIT_MS = 500;

function pageIsIdle(): Promise<void> {
  return new Promise((resolve) => {
    // Safari has no `requestIdleCallback`.
    if (typeof requestIdleCallback === 'function')
      requestIdleCallback(() => resolve(), { timeout: LONGEST_WAIT_MS });
    else setTimeout(resolve);
  });
}
