import { Worker } from 'node:worker_threads';
import { InvalidArgumentError } from '@websplatter/core';
import { type BrickResult, type BrickTask, brickTaskBuffers } from '@websplatter/core/write';
import { Thread } from '@websplatter/node';
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
  readonly #startWorker: () => Worker;
  readonly #all: Thread<BrickTask, BrickAnswer>[] = [];
  readonly #idle: Thread<BrickTask, BrickAnswer>[] = [];
  readonly #waiting: Waiting[] = [];

  /**
   * @param most threads at once.
   * @param startWorker for tests.
   */
  constructor(most: number, startWorker = startBrickWorker) {
    this.#most = most;
    this.#startWorker = startWorker;
  }

  /** Does a task, whose buffers it takes. Rejects as `runBrickTask`, and as `Thread.ask`. */
  readonly run = (task: BrickTask): Promise<BrickResult> =>
    new Promise((resolve, reject) => {
      this.#waiting.push({ task, resolve, reject });
      this.#next();
    });

  /** Ends all threads. */
  async end(): Promise<void> {
    await Promise.all(this.#all.map((thread) => thread.end()));
  }

  #next(): void {
    if (this.#waiting.length === 0) return;
    const thread = this.#idle.pop() ?? this.#start();
    if (!thread) return;
    const { task, resolve, reject } = this.#waiting.shift()!;
    doTask(thread, task)
      .then(resolve, reject)
      .finally(() => {
        // One that has stopped fails the tasks that wait, too: without all of them there is no file.
        this.#idle.push(thread);
        this.#next();
      });
  }

  #start(): Thread<BrickTask, BrickAnswer> | undefined {
    if (this.#all.length >= this.#most) return undefined;
    const thread = new Thread<BrickTask, BrickAnswer>('convert', this.#startWorker());
    this.#all.push(thread);
    return thread;
  }
}

async function doTask(thread: Thread<BrickTask, BrickAnswer>, task: BrickTask): Promise<BrickResult> {
  const answer = await thread.ask(task, brickTaskBuffers(task));
  if ('result' in answer) return answer.result;
  if ('argument' in answer) throw new InvalidArgumentError(answer.argument, answer.message);
  throw answer.error;
}

function startBrickWorker(): Worker {
  return new Worker(new URL('./brick-worker.ts', import.meta.url), {
    resourceLimits: { maxYoungGenerationSizeMb: YOUNG_MB },
  });
}
