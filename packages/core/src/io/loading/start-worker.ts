import { fetched, WebSplatterError } from '../../data/errors.ts';
import { onAbort } from '../../data/on-abort.ts';

/** Makes the self-hosted worker; null if bundler and package provide the workers. */
let makeHosted: (() => Worker) | null = null;

/**
 * Sets the URL of a self-hosted `@websplatter/core/load-worker`, the single script that reads every
 * format and builds colliders. Use it if the bundler cannot emit workers. It affects all later
 * loads of all engines, so call it before the first load.
 *
 * If no worker starts from this URL, one console message says so, and the main thread does the
 * work.
 *
 * @param url resolved against the page. Another origin must allow reads by CORS, as CDNs do. Null,
 *   the default: the workers that the bundler emitted or that lie beside the package's entry.
 * @example
 * setWorkerUrl('/assets/load-worker.js');
 * const cloud = await engine.load('/garden.ply');
 */
export function setWorkerUrl(url: string | URL | null): void {
  makeHosted = url ? () => new Worker(url, { type: 'module' }) : null;
}

/** Makes the self-hosted worker; null if `setWorkerUrl` was not called. */
export const hostedWorker = (): typeof makeHosted => makeHosted;

/**
 * Starts a worker, which posts a message once its script is running, and resolves with the worker
 * then. Resolves with null if none can start: in Node, or in pages whose bundler or content
 * security policy prevents workers. In pages, one console message says so.
 *
 * Rejects with the signal's reason.
 *
 * @param find resolves with a function that makes the worker, and throws if it cannot. Not called
 *   if the platform has no workers.
 */
export async function startWorker(
  find: () => Promise<() => Worker>,
  signal: AbortSignal | undefined,
): Promise<Worker | null> {
  if (typeof Worker === 'undefined') return null;
  const make = await find();
  const start = (from: () => Worker) => tryWorker(from, signal);
  return (
    (await start(make)) ??
    (await fetched('loading', import('./start-elsewhere.ts'))).startElsewhere(make, start)
  );
}

/**
 * The error for a worker that died during its work.
 *
 * @param subject the object of its work.
 * @param workerName for example `loading worker`.
 */
export function workerStopped(
  subject: string,
  workerName: string,
  { message }: Partial<ErrorEvent>,
): WebSplatterError {
  const detail = message ? `: ${message}` : ', perhaps for lack of memory';
  return new WebSplatterError('worker-failed', `${subject}: the ${workerName} stopped${detail}.`);
}

/**
 * Starts a worker. Resolves with it once its script is running, or with null if it cannot start.
 *
 * Rejects with the signal's reason.
 *
 * @param make makes the worker, or throws if it cannot.
 */
async function tryWorker(make: () => Worker, signal: AbortSignal | undefined): Promise<Worker | null> {
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
