import type { GpuMemory } from './gpu-memory.ts';

/** Makes a buffer that is freed once the result has been read. */
export type MakeScratch = (label: string, bytes: number, usage: GPUBufferUsageFlags) => GPUBuffer;

/**
 * Returns the values that `find` reads back, in buffers that live no longer. `find` submits before
 * it returns, so later work makes no difference.
 *
 * @param name, advice as for `GpuMemory.guard`.
 * @throws GpuLimitError if memory is lacking, and the errors of `find`.
 */
export async function readFromScratch(
  memory: GpuMemory,
  name: string,
  advice: string,
  find: (create: MakeScratch) => Promise<ArrayBuffer>,
): Promise<ArrayBuffer> {
  const made: GPUBuffer[] = [];
  const create: MakeScratch = (label, bytes, usage) => {
    const buffer = memory.createBuffer(label, bytes, usage);
    made.push(buffer);
    return buffer;
  };
  try {
    const { result, checked } = memory.guard(name, advice, () => find(create));
    // The lack of memory says more than the missing result.
    result.catch(() => {});
    await checked;
    return await result;
  } finally {
    for (const buffer of made) memory.destroy(buffer);
  }
}
