import { WebSplatterError } from '../../data/errors.ts';
import { tryWorker } from './try-worker.ts';

/**
 * Starts a worker, which posts a message as soon as its script is running. Resolves with it then,
 * and with null where none can start: in Node, or where a bundler left the script out or a content
 * security policy forbids workers, which the console says once.
 *
 * Rejects with the signal's reason.
 *
 * @param find resolves with a function that makes the worker, and throws where it cannot make one.
 * It is not called where there are no workers.
 */
export async function startWorker(
  find: () => Promise<() => Worker>,
  signal: AbortSignal | undefined,
): Promise<Worker | null> {
  if (typeof Worker === 'undefined') return null;
  const make = await find();
  return (
    (await tryWorker(make, signal)) ?? (await import('./start-elsewhere.ts')).startElsewhere(make, signal)
  );
}

/**
 * The error for a worker that died at its work.
 *
 * @param subject the object of its work.
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
