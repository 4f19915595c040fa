import { Worker } from 'node:worker_threads';
import { InvalidArgumentError, WebSplatterError } from '@websplatter/core';
import { type BrickResult, type BrickTask, brickTaskBuffers } from '@websplatter/core/write';
import type { BrickAnswer } from './brick-worker.ts';

/** Megabytes of objects that threads allow before they collect garbage: most of their data are buffers. */
const YOUNG_MB = 8;

interface Waiting {
  readonly task: BrickTask;
  resolve(result: BrickResult): void;
  reject(error: unknown): void;
}

/** Threads that do tasks of a `BrickWriter`. They start as they are needed. */
export class BrickThreads {
  readonly #most: number;
  readonly #all: Worker[] = [];
  readonly #idle: Worker[] = [];
  readonly #waiting: Waiting[] = [];

  /** @param most threads at once. */
  constructor(most: number) {
    this.#most = most;
  }

  /** Does a task, whose buffers it takes. Rejects as `runBrickTask`; with WebSplatterError 'worker-failed'. */
  readonly run = (task: BrickTask): Promise<BrickResult> =>
    new Promise((resolve, reject) => {
      this.#waiting.push({ task, resolve, reject });
      this.#next();
    });

  /** Ends all threads. */
  async end(): Promise<void> {
    await Promise.all(this.#all.map((worker) => worker.terminate()));
  }

  #next(): void {
    if (this.#waiting.length === 0) return;
    const worker = this.#idle.pop() ?? this.#start();
    if (!worker) return;
    const { task, resolve, reject } = this.#waiting.shift()!;
    const onMessage = (answer: BrickAnswer) => {
      worker.off('error', onError);
      this.#idle.push(worker);
      this.#next();
      if ('result' in answer) resolve(answer.result);
      else if ('argument' in answer) reject(new InvalidArgumentError(answer.argument, answer.message));
      else reject(answer.error);
    };
    const onError = (cause: unknown) => {
      worker.off('message', onMessage);
      const message = `convert: a thread stopped: ${(cause as Error).message}.`;
      reject(new WebSplatterError('worker-failed', message, { cause }));
    };
    worker.once('message', onMessage);
    worker.once('error', onError);
    worker.postMessage(task, brickTaskBuffers(task));
  }

  #start(): Worker | undefined {
    if (this.#all.length >= this.#most) return undefined;
    const worker = new Worker(new URL('./brick-worker.ts', import.meta.url), {
      resourceLimits: { maxYoungGenerationSizeMb: YOUNG_MB },
    });
    this.#all.push(worker);
    return worker;
  }
}
