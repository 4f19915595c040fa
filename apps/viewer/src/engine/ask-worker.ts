/** What browsers say no more of than that there is an error. */
export const NOT_STARTED = 'The worker could not be started, or had no memory.';

/**
 * Asks a worker that answers one message with another, one at a time; rejects where it fails or
 * cannot be started.
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
