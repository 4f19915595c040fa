/** Longest time a page's thread is kept busy before its event loop gets a turn. */
const MAX_BUSY_MS = 16;
/** The same where frames are to be drawn meanwhile. */
export const SMOOTH_BUSY_MS = 4;

/** Resolves in a new task, by a message: timers wait for 4 ms in pages, for 1 s in hidden ones. */
export function nextTask(): Promise<void> {
  return new Promise((resolve) => {
    const { port1, port2 } = new MessageChannel();
    port1.onmessage = () => {
      port1.close();
      resolve();
    };
    port2.postMessage(null);
  });
}

/** Lets the event loop take its turns during long work, which a signal may call off. */
export class Turns {
  readonly signal: AbortSignal | undefined;
  readonly #maxBusyMs: number;
  #lastMs = performance.now();

  /** @param maxBusyMs longest time that the thread is kept busy. */
  constructor(signal: AbortSignal | undefined, maxBusyMs = MAX_BUSY_MS) {
    this.signal = signal;
    this.#maxBusyMs = maxBusyMs;
  }

  /** Gives the event loop a turn if it waited long; rejects with an aborted signal's reason. */
  async give(): Promise<void> {
    this.signal?.throwIfAborted();
    if (performance.now() - this.#lastMs < this.#maxBusyMs) return;
    await nextTask();
    this.#lastMs = performance.now();
    this.signal?.throwIfAborted();
  }
}
