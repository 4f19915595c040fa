import type { BrickTask } from './brick-tasks.ts';

/**
 * Buffers that only this task uses, for a transfer list.
 *
 * @example
 * // `worker` answers with the result of runBrickTask.
 * const writer = await openBrickWriter({
 *   run: (task) =>
 *     new Promise((resolve) => {
 *       worker.onmessage = ({ data }) => resolve(data);
 *       worker.postMessage(task, brickTaskBuffers(task));
 *     }),
 * });
 */
export function brickTaskBuffers(task: BrickTask): ArrayBuffer[] {
  const arrays =
    task.kind === 'records'
      ? Object.values({ ...task.set, ...task.set.harmonics })
      : 'parts' in task
        ? task.parts.map(({ words }) => words)
        : Object.values(task.leaves);
  return arrays.filter((each) => ArrayBuffer.isView(each)).map(({ buffer }) => buffer as ArrayBuffer);
}
