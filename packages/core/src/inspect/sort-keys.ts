import { GpuMemory } from '../gpu/gpu-memory.ts';
import { recordDispatches } from '../gpu/passes.ts';
import type { Pipelines } from '../gpu/pipelines.ts';
import { readWords } from '../gpu/read-buffer.ts';
import { RadixSort, radixSortStages } from '../stages/sort/radix-sort.ts';
import { type SortShape, sortDeviceOf, sortPlanOf, sortShapeFor } from '../stages/sort/sort.ts';

/**
 * Runs the GPU's sort alone.
 *
 * @param keys below 2^keyBits.
 * @param dispatchRow largest number of workgroups in one dimension of a dispatch; default: the
 *   device's limit.
 * @returns the index of each key in ascending order of keys.
 */
export async function sortKeys(
  device: GPUDevice,
  pipelines: Pipelines,
  keys: Uint32Array,
  keyBits: number,
  dispatchRow = device.limits.maxComputeWorkgroupsPerDimension,
  shape: SortShape = sortShapeFor(keyBits, sortDeviceOf(device)),
): Promise<Uint32Array> {
  await pipelines.prepare(radixSortStages(shape));
  const memory = new GpuMemory(device);
  const sort = new RadixSort(device, pipelines, memory, {
    shape,
    plan: memory.createFilledBuffer('sort plan', sortPlanOf(keys.length, shape)),
    capacity: Math.max(1, keys.length),
    dispatchRow,
  });
  // Deno 2.9 ends at a write of no bytes.
  if (keys.length > 0) device.queue.writeBuffer(sort.keys, 0, Uint32Array.from(keys));
  const encoder = device.createCommandEncoder();
  const pass = encoder.beginComputePass();
  recordDispatches(pass, sort.dispatches);
  pass.end();
  device.queue.submit([encoder.finish()]);
  const order = (await readWords(device, sort.order)).slice(0, keys.length);
  memory.destroyAll();
  return order;
}
