import { onAbort } from '../../data/on-abort.ts';

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
    const ignoreSignal = onAbort(signal, () => {
      worker.terminate();
      reject(signal?.reason);
    });
    worker.onmessage = () => {
      ignoreSignal();
      resolve(worker);
    };
    worker.onerror = (event) => {
      event.preventDefault();
      ignoreSignal();
      resolve(endWorker(worker));
    };
  });
}

export function endWorker(worker: Worker | null): null {
  worker?.terminate();
  return null;
}
