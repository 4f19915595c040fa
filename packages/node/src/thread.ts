import type { Transferable, Worker } from 'node:worker_threads';
import { WebSplatterError } from '@websplatter/core';

/** A pending request. */
interface Asked<Answer> {
  resolve(answer: Answer): void;
  reject(error: WebSplatterError): void;
}

/**
 * A thread that answers messages with messages, one at a time. If it ends by itself, such as for lack
 * of memory, the pending request and all later ones reject.
 */
export class Thread<Request, Answer> {
  readonly #worker: Worker;
  readonly #task: string;
  #asked: Asked<Answer> | undefined;
  #failure: WebSplatterError | undefined;

  /** @param task the thread's task, for messages: `convert`. */
  constructor(task: string, worker: Worker) {
    this.#task = task;
    this.#worker = worker;
    worker.on('message', (answer: Answer) => {
      const asked = this.#asked;
      this.#asked = undefined;
      asked?.resolve(answer);
    });
    worker.on('error', (cause) => this.#fail((cause as Error).message, cause));
    worker.on('messageerror', (cause) => this.#fail(`its answer cannot be read: ${cause.message}`, cause));
    worker.on('exit', (status) => this.#fail(`it ended with status ${status}`));
  }

  /**
   * Sends a request with the buffers of `transfer`, and resolves with the answer. Await it before the
   * next call.
   *
   * Rejects with WebSplatterError 'worker-failed' if the thread ends, or has ended, without an answer.
   */
  ask(request: Request, transfer: readonly Transferable[] = []): Promise<Answer> {
    return new Promise((resolve, reject) => {
      if (this.#failure) return reject(this.#failure);
      this.#asked = { resolve, reject };
      this.#worker.postMessage(request, transfer);
    });
  }

  /** Ends the thread. */
  async end(): Promise<void> {
    await this.#worker.terminate();
  }

  /** Keeps the first cause: an error event is followed by an exit event. */
  #fail(why: string, cause?: unknown): void {
    this.#failure ??= new WebSplatterError(
      'worker-failed',
      `${this.#task}: a thread stopped: ${why}. Try it again, with more memory free.`,
      { cause },
    );
    this.#asked?.reject(this.#failure);
    this.#asked = undefined;
  }
}
