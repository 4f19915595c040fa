import { fetched, WebSplatterError } from '../../data/errors.ts';
import { tryWorker } from './try-worker.ts';

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
  return (
    (await tryWorker(make, signal)) ??
    (await fetched('loading', import('./start-elsewhere.ts'))).startElsewhere(make, signal)
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
