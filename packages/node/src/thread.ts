import type { Transferable, Worker } from 'node:worker_threads';
import { WebSplatterError } from '@websplatter/core';

/** A question that has no answer yet. */
interface Asked<Answer> {
  resolve(answer: Answer): void;
  reject(error: WebSplatterError): void;
}

/**
 * A thread that answers messages with messages, one at a time. One that ends by itself, for want of
 * memory say, fails the question that it was asked and all later ones: nobody waits for it.
 */
export class Thread<Request, Answer> {
  readonly #worker: Worker;
  readonly #what: string;
  #asked: Asked<Answer> | undefined;
  #failure: WebSplatterError | undefined;

  /** @param what the thread works for, in messages: `convert`. */
  constructor(what: string, worker: Worker) {
    this.#what = what;
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
   * Asks for an answer, and gives the buffers of `transfer` away. To be called again only once the
   * last answer has come.
   *
   * Rejects with WebSplatterError 'worker-failed' if the thread ends, or has ended, without it.
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

  /** The first cause counts: an error is followed by the end. */
  #fail(why: string, cause?: unknown): void {
    this.#failure ??= new WebSplatterError(
      'worker-failed',
      `${this.#what}: a thread stopped: ${why}. Try it again, with more memory free.`,
      { cause },
    );
    this.#asked?.reject(this.#failure);
    this.#asked = undefined;
  }
}
