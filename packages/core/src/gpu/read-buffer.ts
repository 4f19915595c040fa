import { readBack } from './read-back.ts';

/** Copies the first `count` words of a buffer to the CPU, by default all. @throws GpuLimitError if memory is lacking. */
export async function readWords(
  device: GPUDevice,
  buffer: GPUBuffer,
  count = buffer.size / 4,
): Promise<Uint32Array<ArrayBuffer>> {
  const size = 4 * count;
  const copy = (encoder: GPUCommandEncoder, target: GPUBuffer) =>
    encoder.copyBufferToBuffer(buffer, 0, target, 0, size);
  return new Uint32Array(await readBack(device, size, copy));
}
