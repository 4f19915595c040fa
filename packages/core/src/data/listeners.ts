// Functions of callers that this library calls. All are called here: an error in one is reported, and
// changes nothing for the library or for other listeners. Who calls them has changed its own state
// before, or lets the calls wait for the end of the change in a microtask.

/** Reports an error that nobody waits for: to pages as an uncaught one, else on the console. */
function reportUncaught(error: unknown): void {
  if (typeof globalThis.reportError === 'function') globalThis.reportError(error);
  else console.error(error);
}

/**
 * Calls a listener, if there is one. If it throws or its promise rejects, the error is reported as
 * uncaught: by `reportError`, or on the console of a system without it.
 *
 * @hidden Shared with the packages beside this one.
 * @example
 *     callListener(options.onProgress, 0.5);
 */
export function callListener<Args extends readonly unknown[]>(
  listener: ((...args: Args) => unknown) | null | undefined,
  ...args: Args
): void {
  try {
    const result = listener?.(...args);
    if (result instanceof Promise) result.catch(reportUncaught);
  } catch (error) {
    reportUncaught(error);
  }
}

/**
 * Returns a function that calls `listener` as `callListener` does; undefined without a listener.
 *
 * @example
 *     const onProgress = guarded(options.onProgress);
 */
export function guarded<Args extends readonly unknown[]>(
  listener: ((...args: Args) => unknown) | null | undefined,
): ((...args: Args) => void) | undefined {
  return listener ? (...args) => callListener(listener, ...args) : undefined;
}

/**
 * Listeners for one thing, called as `callListener` does.
 *
 * @hidden Shared with the packages beside this one.
 * @example
 *     const listeners = new Listeners<[number]>();
 *     const stop = listeners.add((value) => console.log(value));
 *     listeners.call(1);
 *     stop();
 */
export class Listeners<Args extends readonly unknown[] = []> {
  readonly #entries = new Set<{ readonly listener: (...args: Args) => unknown }>();

  get size(): number {
    return this.#entries.size;
  }

  /** Adds a listener, each time anew. Returns a function that removes it. */
  add(listener: (...args: Args) => unknown): () => void {
    const entry = { listener };
    this.#entries.add(entry);
    return () => {
      this.#entries.delete(entry);
    };
  }

  /** Calls all listeners, except any that an earlier one of them removes. */
  call(...args: Args): void {
    for (const entry of [...this.#entries])
      if (this.#entries.has(entry)) callListener(entry.listener, ...args);
  }

  clear(): void {
    this.#entries.clear();
  }
}
