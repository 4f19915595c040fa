/** A thread that does tasks of a `BrickWriter`, one at a time. */
import { parentPort } from 'node:worker_threads';
import { deflateSync } from 'node:zlib';
import { type BrickTask, runBrickTask, serve } from '@websplatter/core/write';

const TASKS = {
  run: async (task: BrickTask) => {
    const { result } = await runBrickTask(task, (bytes) => new Uint8Array(deflateSync(bytes)));
    return result;
  },
};

export type BrickWorkerTasks = typeof TASKS;

serve(TASKS, parentPort as never);
