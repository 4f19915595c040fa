/** By signal, what its one listener calls. */
const sharedOf = new WeakMap<AbortSignal, { readonly calls: Set<() => void>; readonly tell: () => void }>();

/**
 * Calls `listener`, which does not throw, once the signal aborts; not at all if it has. All such
 * listeners of a signal share one of its own: parts of a scene that are read at once are many, and
 * Node takes more than ten for a leak and warns.
 *
 * @param listener is another one than those that listen already.
 * @returns a function that removes the listener.
 *
 * @example
 *     const ignoreSignal = onAbort(signal, () => reject(signal?.reason));
 */
export function onAbort(signal: AbortSignal | undefined, listener: () => void): () => void {
  if (!signal) return () => {};
  const { calls, tell } = sharedOf.get(signal) ?? share(signal);
  // Where it listens already, this changes nothing.
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
