import { Worker } from 'node:worker_threads';
import {
  type BrickResult,
  type BrickTask,
  brickTaskBuffers,
  Remote,
  RemotePool,
} from '@websplatter/core/write';
import { threadPort } from '@websplatter/node';
import type { BrickWorkerTasks } from './brick-worker.ts';

/** Megabytes of objects that threads allow before they collect garbage: most of their data are buffers. */
const YOUNG_MB = 8;

/** Threads that do tasks of a `BrickWriter`. They start as they are needed. */
export class BrickThreads {
  readonly #pool: RemotePool<BrickWorkerTasks>;

  /**
   * @param most threads at once.
   * @param startWorker for tests.
   */
  constructor(most: number, startWorker = startBrickWorker) {
    const failure = ({ error }: Partial<ErrorEvent>) => error;
    const start = () => new Remote<BrickWorkerTasks>(() => threadPort('convert', startWorker()), { failure });
    this.#pool = new RemotePool(most, start);
  }

  /** Does a task, whose buffers it takes. Rejects as `runBrickTask`, and if a thread stops. */
  readonly run = (task: BrickTask): Promise<BrickResult> =>
    this.#pool.call('run', task, { transfer: brickTaskBuffers(task) });

  /** Ends all threads. */
  async end(): Promise<void> {
    await this.#pool.end();
  }
}

function startBrickWorker(): Worker {
  return new Worker(new URL('./brick-worker.ts', import.meta.url), {
    resourceLimits: { maxYoungGenerationSizeMb: YOUNG_MB },
  });
}
