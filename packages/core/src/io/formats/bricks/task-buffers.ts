import type { BrickTask } from './brick-tasks.ts';

/** Buffers that a task has for itself, to be posted with it in place of copies. */
export function taskBuffers(task: BrickTask): ArrayBuffer[] {
  const arrays =
    task.kind === 'records'
      ? Object.values({ ...task.set, ...task.set.harmonics })
      : 'parts' in task
        ? task.parts.map(({ words }) => words)
        : Object.values(task.leaves);
  return arrays.filter((each) => ArrayBuffer.isView(each)).map(({ buffer }) => buffer as ArrayBuffer);
}
