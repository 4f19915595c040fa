/**
 * Starts `make`'s worker. Resolves with it once its script runs, or with null if none can start.
 *
 * Rejects with the signal's reason.
 *
 * @param make throws where it cannot make one.
 */
export async function tryWorker(make: () => Worker, signal: AbortSignal | undefined): Promise<Worker | null> {
  signal?.throwIfAborted();
  let worker: Worker;
  try {
    worker = make();
  } catch {
    return null;
  }
  return new Promise((resolve, reject) => {
    const onAbort = () => {
      worker.terminate();
      reject(signal?.reason);
    };
    signal?.addEventListener('abort', onAbort, { once: true });
    worker.onmessage = () => {
      signal?.removeEventListener('abort', onAbort);
      resolve(worker);
    };
    worker.onerror = (event) => {
      event.preventDefault();
      signal?.removeEventListener('abort', onAbort);
      resolve(endWorker(worker));
    };
  });
}

export function endWorker(worker: Worker | null): null {
  worker?.terminate();
  return null;
}
