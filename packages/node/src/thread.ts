import type { Worker } from 'node:worker_threads';
import { WebSplatterError } from '@websplatter/core';

/** A thread as the port of a `Remote`. */
interface ThreadPort {
  onmessage: ((event: MessageEvent) => void) | null;
  onmessageerror: ((event: MessageEvent) => void) | null;
  onerror: ((event: ErrorEvent) => void) | null;
  postMessage(request: unknown, transfer: Transferable[]): void;
  terminate(): Promise<number>;
}

/**
 * Returns the port of a thread. If the thread ends by itself, such as for lack of memory, `onerror`
 * gets a WebSplatterError 'worker-failed' in an event's `error`.
 *
 * @param task the thread's task, for messages: `convert`.
 */
export function threadPort(task: string, worker: Worker): ThreadPort {
  const port: ThreadPort = {
    onmessage: null,
    onmessageerror: null,
    onerror: null,
    postMessage: (request, transfer) => worker.postMessage(request, transfer as never),
    terminate: () => worker.terminate(),
  };
  const fail = (why: string, cause?: unknown) => {
    const message = `${task}: a thread stopped: ${why}. Try it again, with more memory free.`;
    port.onerror?.({ error: new WebSplatterError('worker-failed', message, { cause }) } as ErrorEvent);
  };
  worker.on('message', (data) => port.onmessage?.({ data } as MessageEvent));
  worker.on('error', (cause: Error) => fail(cause.message, cause));
  worker.on('messageerror', (cause) => fail(`its answer cannot be read: ${cause.message}`, cause));
  worker.on('exit', (status) => fail(`it ended with status ${status}`));
  return port;
}
