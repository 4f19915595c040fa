import type { GpuMemory } from './gpu-memory.ts';

/** Whether `bytes` more can be allocated now, within the budget: allocates and frees them. */
export async function probeMemory({ device, availableBytes }: GpuMemory, bytes: number): Promise<boolean> {
  if (bytes > availableBytes) return false;
  await reclaimMemory(device);
  const { maxBufferSize } = device.limits;
  const made: GPUBuffer[] = [];
  device.pushErrorScope('out-of-memory');
  for (let left = Math.ceil(bytes / 4) * 4; left > 0; left -= maxBufferSize) {
    const size = Math.min(left, maxBufferSize);
    made.push(device.createBuffer({ label: 'probe', size, usage: GPUBufferUsage.COPY_DST }));
  }
  const error = device.popErrorScope();
  for (const buffer of made) buffer.destroy();
  // A lost device does not answer; callers notice its loss themselves.
  const isLacking = (await error.catch(() => null)) !== null;
  await reclaimMemory(device);
  return !isLacking;
}

/**
 * Waits until destroyed memory is free. Dawn frees memory when a later submission is done. Without
 * one, a buffer of 256 MiB was still held after `onSubmittedWorkDone`; an empty list of command
 * buffers does not count as a submission.
 */
export async function reclaimMemory(device: GPUDevice): Promise<void> {
  device.queue.submit([device.createCommandEncoder({ label: 'reclaim memory' }).finish()]);
  // A lost device has no memory to give back.
  await device.queue.onSubmittedWorkDone().catch(() => {});
}
