/** Message for worker errors to which the browser gives no text. */
export const NOT_STARTED = 'The worker could not be started, or had no memory.';

/**
 * Sends a worker one request and resolves with its answer. Only one request at a time. Rejects if
 * the worker fails or cannot start.
 */
export function askWorker<Answer>(
  worker: Worker,
  request: unknown,
  transfer: Transferable[] = [],
): Promise<Answer> {
  return new Promise((resolve, reject) => {
    worker.onmessage = ({ data }: MessageEvent<Answer>) => resolve(data);
    worker.onerror = (event) => reject(new Error(event.message || NOT_STARTED));
    worker.postMessage(request, transfer);
  });
}
