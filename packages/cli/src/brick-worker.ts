/** A thread that does tasks of a `BrickWriter`, one at a time. */
import { parentPort } from 'node:worker_threads';
import { deflateSync } from 'node:zlib';
import { type BrickResult, type BrickTask, runBrickTask } from '@websplatter/core/write';

/** A worker's answer to a task: the result, or an InvalidArgumentError's fields, or another error. */
export type BrickAnswer =
  | { readonly result: BrickResult }
  | { readonly argument: string; readonly message: string }
  | { readonly error: unknown };

parentPort?.on('message', async (task: BrickTask) => {
  try {
    const { result, buffers } = await runBrickTask(task, (bytes) => new Uint8Array(deflateSync(bytes)));
    parentPort?.postMessage({ result } satisfies BrickAnswer, [...buffers]);
  } catch (error) {
    // Errors lose their class where they are posted.
    const { argument, message } = error as { readonly argument?: string; readonly message: string };
    parentPort?.postMessage(
      (argument === undefined ? { error } : { argument, message }) satisfies BrickAnswer,
    );
  }
});
