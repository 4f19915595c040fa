import { WebSplatterError } from '../../errors.ts';

/**
 * Starts a worker, which posts a message as soon as its script is running. Resolves with it then, and with null where none can
 * start: in Node, or under a content security policy that forbids workers.
 *
 * Rejects with the signal's reason.
 *
 * @param make throws or rejects where it cannot make one.
 */
export async function startWorker(
  make: () => Worker | Promise<Worker>,
  signal: AbortSignal | undefined,
): Promise<Worker | null> {
  if (typeof Worker === 'undefined') return null;
  let worker: Worker;
  try {
    worker = await make();
  } catch {
    return null;
  }
  if (signal?.aborted) {
    worker.terminate();
    throw signal.reason;
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

/**
 * The error for a worker that died at its work.
 *
 * @param subject what it worked on.
 * @param workerName `loading worker`.
 */
export function workerStopped(
  subject: string,
  workerName: string,
  { message }: Partial<ErrorEvent>,
): WebSplatterError {
  const detail = message ? `: ${message}` : ', perhaps for lack of memory';
  return new WebSplatterError('worker-failed', `${subject}: the ${workerName} stopped${detail}.`);
}
