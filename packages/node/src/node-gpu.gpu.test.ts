import { WebGpuUnavailableError } from '@websplatter/core';
import { expect, vi } from 'vitest';
import { createTestDevice, gpuTest } from './gpu-test.ts';
import { createNodeGpu } from './node-gpu.ts';

gpuTest('finds an adapter and names it', async () => {
  const { adapter, label, isSoftware, notice } = await createNodeGpu();
  expect(label).not.toBe('');
  expect(adapter.limits.maxBufferSize).toBeGreaterThan(0);
  expect(notice === null).toBe(!isSoftware);
  expect(globalThis.GPUBufferUsage.STORAGE).toBe(0x80);
});

gpuTest('uses the software adapter when asked for it', async ({ skip }) => {
  const software = await createNodeGpu({ forceSoftware: true }).catch((error) => error);
  if (software instanceof WebGpuUnavailableError && !(await createNodeGpu()).isSoftware)
    skip('no software driver here');
  expect(software).toMatchObject({ isSoftware: true, notice: expect.stringContaining('software') });
});

gpuTest('every call gives an adapter that a device can be made from', async () => {
  const first = await createTestDevice();
  const second = await createTestDevice();
  expect(first).not.toBe(second);
  first.destroy();
  second.destroy();
});

gpuTest('a buffer goes to the GPU and comes back', async () => {
  const device = await createTestDevice();
  const numbers = Float32Array.from({ length: 1024 }, (_, i) => Math.sin(i));
  const size = numbers.byteLength;
  const source = device.createBuffer({ size, usage: GPUBufferUsage.COPY_SRC | GPUBufferUsage.COPY_DST });
  const target = device.createBuffer({ size, usage: GPUBufferUsage.MAP_READ | GPUBufferUsage.COPY_DST });
  device.queue.writeBuffer(source, 0, numbers);
  const encoder = device.createCommandEncoder();
  encoder.copyBufferToBuffer(source, 0, target, 0, size);
  device.queue.submit([encoder.finish()]);
  await target.mapAsync(GPUMapMode.READ);
  expect(new Float32Array(target.getMappedRange().slice(0))).toEqual(numbers);
  target.unmap();
});

gpuTest('the search leaves no driver setting behind for child processes', async () => {
  // As in a container: the search gives this variable a value of its own.
  vi.stubEnv('XDG_RUNTIME_DIR', undefined);
  const before = { ...process.env };
  // Another copy of the module, since this one has searched already.
  vi.resetModules();
  const copy = await import('./node-gpu.ts');
  await copy.createNodeGpu();
  expect({ ...process.env }).toEqual(before);
  vi.unstubAllEnvs();
});

gpuTest.fails('a validation error that is not looked at fails the test', async () => {
  const device = await createTestDevice();
  device.createBuffer({ size: 16, usage: 0 });
});
