/** The one `abort` listener of each signal, `tell`, and the functions that it calls. */
const sharedOf = new WeakMap<AbortSignal, { readonly calls: Set<() => void>; readonly tell: () => void }>();

/**
 * Calls `listener` once the signal aborts; never if it has aborted already. All listeners of a signal
 * share one event listener: parts of a scene are read in large numbers at once, and Node warns of a
 * leak at more than ten.
 *
 * @param listener does not throw, and is not registered for the signal yet.
 * @returns a function that removes the listener.
 *
 * @example
 *     const ignoreSignal = onAbort(signal, () => reject(signal?.reason));
 */
export function onAbort(signal: AbortSignal | undefined, listener: () => void): () => void {
  if (!signal) return () => {};
  const { calls, tell } = sharedOf.get(signal) ?? share(signal);
  // No effect if `tell` is registered already.
  signal.addEventListener('abort', tell, { once: true });
  calls.add(listener);
  return () => {
    calls.delete(listener);
    if (calls.size === 0) signal.removeEventListener('abort', tell);
  };
}

function share(signal: AbortSignal) {
  const calls = new Set<() => void>();
  const tell = () => {
    for (const call of calls) call();
    calls.clear();
  };
  const shared = { calls, tell };
  sharedOf.set(signal, shared);
  return shared;
}
