import { type BrickResult, type BrickTask, buffersOf, runTask } from '../formats/bricks/brick-tasks.ts';
import { taskBuffers } from '../formats/bricks/task-buffers.ts';
import { fromPostedError, toPostedError } from '../loading/load-messages.ts';
import type { HelperAnswer, HelperTask } from './keep-messages.ts';

/** Does the tasks that come through a port, one after another. */
export function serveTasks(port: MessagePort): void {
  port.onmessage = async ({ data: task }: MessageEvent<HelperTask>) => {
    try {
      const result = await runTask(task);
      port.postMessage({ result } satisfies HelperAnswer, [...buffersOf(result)]);
    } catch (error) {
      port.postMessage({ error: toPostedError(error) } satisfies HelperAnswer);
    }
  };
}

/** Has tasks done by helpers, each of which does one at a time. */
export class Helpers {
  readonly #idle: MessagePort[];
  readonly #waiting: (() => void)[] = [];

  constructor(ports: readonly MessagePort[]) {
    this.#idle = [...ports];
  }

  /** Does a task, whose buffers it takes. Rejects as `runTask`. */
  readonly run = async (task: BrickTask): Promise<BrickResult> => {
    while (this.#idle.length === 0) await new Promise<void>((resolve) => this.#waiting.push(resolve));
    const port = this.#idle.pop()!;
    const answer = await new Promise<HelperAnswer>((resolve) => {
      port.onmessage = ({ data }) => resolve(data);
      port.postMessage(task satisfies HelperTask, taskBuffers(task));
    });
    this.#idle.push(port);
    this.#waiting.shift()?.();
    if ('error' in answer) throw fromPostedError(answer.error);
    return answer.result;
  };
}
