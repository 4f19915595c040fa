import { DestroyedError, GpuLimitError } from '../data/errors.ts';

/**
 * Copies bytes to the CPU. Submits before it returns, so that nothing that follows changes them.
 *
 * @param record records the copy into a buffer of `size` bytes.
 * @throws GpuLimitError if `size` exceeds `maxBufferSize`, or memory is lacking; DestroyedError if
 *   the device ends before.
 */
export async function readBack(
  device: GPUDevice,
  size: number,
  record: (encoder: GPUCommandEncoder, target: GPUBuffer) => void,
): Promise<ArrayBuffer> {
  const { maxBufferSize } = device.limits;
  if (size > maxBufferSize) {
    const message = `Reading back ${size} bytes needs a buffer larger than this device's ${maxBufferSize} bytes (maxBufferSize).`;
    throw new GpuLimitError('maxBufferSize', size, maxBufferSize, message);
  }
  device.pushErrorScope('validation');
  device.pushErrorScope('out-of-memory');
  const usage = GPUBufferUsage.COPY_DST | GPUBufferUsage.MAP_READ;
  const target = device.createBuffer({ label: 'read-back', size, usage });
  const encoder = device.createCommandEncoder({ label: 'read-back' });
  record(encoder, target);
  device.queue.submit([encoder.finish()]);
  const mapping = target.mapAsync(GPUMapMode.READ);
  const errors = [device.popErrorScope(), device.popErrorScope()];
  try {
    // Each outcome is thrown below. A lost device rejects them all.
    const [mapped, lacking, invalid] = await Promise.allSettled([mapping, ...errors]);
    if (lacking.status === 'fulfilled' && lacking.value) {
      const message = `Reading back needs ${size} bytes of memory, which the GPU lacks. Read a smaller image, or show less.`;
      throw new GpuLimitError('memory', size, 0, message, { cause: lacking.value });
    }
    if (mapped.status === 'rejected') throw new DestroyedError('What was read back', mapped.reason.message);
    if (invalid.status === 'fulfilled' && invalid.value) throw new Error(invalid.value.message);
    return target.getMappedRange().slice(0);
  } finally {
    target.destroy();
  }
}
