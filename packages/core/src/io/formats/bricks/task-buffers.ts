import type { BrickTask } from './brick-tasks.ts';

/** Buffers that only this task uses, for a transfer list. */
export function taskBuffers(task: BrickTask): ArrayBuffer[] {
  const arrays =
    task.kind === 'records'
      ? Object.values({ ...task.set, ...task.set.harmonics })
      : 'parts' in task
        ? task.parts.map(({ words }) => words)
        : Object.values(task.leaves);
  return arrays.filter((each) => ArrayBuffer.isView(each)).map(({ buffer }) => buffer as ArrayBuffer);
}
