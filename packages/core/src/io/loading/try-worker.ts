import { onAbort } from '../../data/on-abort.ts';

/**
 * Starts a worker. Resolves with it once its script is running, or with null if it cannot start.
 *
 * Rejects with the signal's reason.
 *
 * @param make makes the worker, or throws if it cannot.
 */
export async function tryWorker(make: () => Worker, signal: AbortSignal | undefined): Promise<Worker | null> {
  signal?.throwIfAborted();
  let worker: Worker;
  try {
    worker = make();
  } catch {
    // `startElsewhere` tries another way, and tells of a failure.
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
