/** Copies the first `count` words of a buffer to the CPU, by default all. */
export async function readWords(
  device: GPUDevice,
  buffer: GPUBuffer,
  count = buffer.size / 4,
): Promise<Uint32Array<ArrayBuffer>> {
  const size = 4 * count;
  const target = device.createBuffer({
    size,
    usage: GPUBufferUsage.COPY_DST | GPUBufferUsage.MAP_READ,
  });
  const encoder = device.createCommandEncoder();
  encoder.copyBufferToBuffer(buffer, 0, target, 0, size);
  device.queue.submit([encoder.finish()]);
  await target.mapAsync(GPUMapMode.READ);
  const words = new Uint32Array(target.getMappedRange().slice(0));
  target.destroy();
  return words;
}
