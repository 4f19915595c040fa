import { readBack } from './read-back.ts';

/** Copies `count` words of a buffer from `first` on; default all. @throws GpuLimitError. */
export async function readWords(
  device: GPUDevice,
  buffer: GPUBuffer,
  count = buffer.size / 4,
  first = 0,
): Promise<Uint32Array<ArrayBuffer>> {
  const size = 4 * count;
  const copy = (encoder: GPUCommandEncoder, target: GPUBuffer) =>
    encoder.copyBufferToBuffer(buffer, 4 * first, target, 0, size);
  return new Uint32Array(await readBack(device, size, copy));
}
