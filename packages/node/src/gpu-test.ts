import { afterEach, test } from 'vitest';
import { createNodeGpu } from './node-gpu.ts';

/**
 * `test` for tests that need a GPU. Where no adapter is found, they are skipped with a printed reason; in CI and under
 * `WEBSPLATTER_REQUIRE_GPU` the file fails instead.
 */
export const gpuTest = (await isGpuUsable()) ? test : test.skip;

/** Devices whose errors fail the running test. */
const watched = new Map<GPUDevice, string[]>();
const closing = new WeakSet<GPUDevice>();

/**
 * Returns a device for tests. Any validation error, other uncaptured error or loss fails the test in which it happens.
 * Call the device's `destroy()`, or leave it to the end of the file.
 */
export async function createTestDevice(
  options: Pick<GPUDeviceDescriptor, 'requiredLimits' | 'requiredFeatures'> = {},
): Promise<GPUDevice> {
  const { adapter } = await createNodeGpu();
  const device = await adapter.requestDevice({ label: 'test device', ...options });
  watchDevice(device);
  return device;
}

/** Fails the running test on any error or loss of `device`, for devices that a test makes itself. */
export function watchDevice(device: GPUDevice): void {
  const errors: string[] = [];
  watched.set(device, errors);
  device.addEventListener('uncapturederror', (event) => {
    event.preventDefault();
    errors.push(`${event.error.constructor.name}: ${event.error.message}`);
  });
  const destroy = device.destroy.bind(device);
  device.destroy = () => {
    closing.add(device);
    return destroy();
  };
  void device.lost.then((info) => {
    if (!closing.has(device)) errors.push(`device lost (${info.reason}): ${info.message}`);
  });
}

afterEach(async () => {
  const errors: string[] = [];
  for (const [device, found] of watched) {
    // Errors are reported before submitted work is done; a lost device reports nothing more.
    if (!closing.has(device))
      await Promise.race([device.queue.onSubmittedWorkDone(), device.lost]).catch(() => {});
    errors.push(...found.splice(0));
    if (closing.has(device)) watched.delete(device);
  }
  if (errors.length > 0) throw new Error(`GPU errors during this test:\n${errors.join('\n')}`);
});

async function isGpuUsable(): Promise<boolean> {
  try {
    await createNodeGpu();
    return true;
  } catch (error) {
    if (process.env.CI || process.env.WEBSPLATTER_REQUIRE_GPU) throw error;
    console.warn(`GPU tests are skipped: ${error instanceof Error ? error.message : error}`);
    return false;
  }
}
