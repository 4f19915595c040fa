import type { GpuMemory } from './gpu-memory.ts';

/**
 * Returns the values that `find` reads back from temporary buffers, and frees the buffers. `find`
 * submits before it returns, so later work does not change the values.
 *
 * @param name, advice as `subject` and `advice` of `GpuMemory.guard`.
 * @param find creates its buffers in `scratch`.
 * @throws GpuLimitError if memory is lacking, and the errors of `find`.
 */
export async function readFromScratch(
  memory: GpuMemory,
  name: string,
  advice: string,
  find: (scratch: GpuMemory) => Promise<ArrayBuffer>,
): Promise<ArrayBuffer> {
  const scratch = memory.part();
  try {
    const { result, checked } = memory.guard(name, advice, () => find(scratch));
    // The lack of memory says more than the missing result.
    result.catch(() => {});
    await checked;
    return await result;
  } finally {
    scratch.destroyAll();
  }
}
