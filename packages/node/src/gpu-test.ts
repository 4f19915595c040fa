import { test } from 'vitest';
import { createNodeGpu } from './node-gpu.ts';
import { watchDevice } from './testing/device-errors.ts';
import { lendDevice } from './testing/shared-devices.ts';

export { watchDevice };

/**
 * `test` for tests that need a GPU. Without an adapter they are skipped with a printed reason; in
 * CI and under `WEBSPLATTER_REQUIRE_GPU` the file fails instead.
 */
export const gpuTest = (await isGpuUsable()) ? test : test.skip;

/**
 * Returns a device for tests. Any validation error, other uncaptured error or loss fails the running
 * test. The device is destroyed at the end of the test file, unless a test has destroyed it.
 */
export async function createTestDevice(
  options: Pick<GPUDeviceDescriptor, 'requiredLimits' | 'requiredFeatures'> = {},
): Promise<GPUDevice> {
  const { adapter } = await createNodeGpu();
  const device = await adapter.requestDevice({ label: 'test device', ...options });
  watchDevice(device);
  return device;
}

/**
 * As `createTestDevice`, for tests that destroy their device when they are done. The device is reused
 * by later tests of the process, so that SwiftShader compiles the same shaders only once.
 */
export async function shareTestDevice(options: GPUDeviceDescriptor = {}): Promise<GPUDevice> {
  const { adapter } = await createNodeGpu();
  const device = await lendDevice(adapter, options);
  watchDevice(device);
  return device;
}

/**
 * As `shareTestDevice`, with float32 blending, which the preset `reference` uses, and timestamps, if the
 * adapter has them. Tests of either share this kind of device, so that its shaders are compiled once.
 */
export async function shareBlendingDevice(): Promise<GPUDevice> {
  const { adapter } = await createNodeGpu();
  const offered = ['float32-blendable', 'timestamp-query'] as GPUFeatureName[];
  return shareTestDevice({ requiredFeatures: offered.filter((feature) => adapter.features.has(feature)) });
}

/** A `GPU` whose adapters give shared devices. Their errors do not fail the test. */
export const sharedTestGpu = {
  async requestAdapter(): Promise<GPUAdapter> {
    const { adapter } = await createNodeGpu();
    const requestDevice = (descriptor?: GPUDeviceDescriptor) => lendDevice(adapter, descriptor);
    return new Proxy(adapter, {
      get: (target, name) => (name === 'requestDevice' ? requestDevice : Reflect.get(target, name)),
    });
  },
};

async function isGpuUsable(): Promise<boolean> {
  try {
    const { isSoftware } = await createNodeGpu();
    if (isSoftware) waitPatiently();
    return true;
  } catch (error) {
    if (process.env.CI || process.env.WEBSPLATTER_REQUIRE_GPU) throw error;
    console.warn(`GPU tests are skipped: ${error instanceof Error ? error.message : error}`);
    return false;
  }
}

/** Time between two polls of the GPU, ms. At a tenth of it, all tests together take a tenth more CPU time. */
const POLL_MS = 2;

/**
 * Makes `setImmediate` sleep first. Dawn polls the GPU in each turn of the event loop, and requests
 * the next turn by `setImmediate`, which keeps one core busy. Software adapters need that core for
 * the work itself.
 */
function waitPatiently(): void {
  const { setImmediate } = globalThis;
  const neverChanged = new Int32Array(new SharedArrayBuffer(4));
  const patient: (...turn: Parameters<typeof setImmediate>) => NodeJS.Immediate = (callback, ...values) =>
    setImmediate(() => {
      Atomics.wait(neverChanged, 0, 0, POLL_MS);
      callback(...values);
    });
  globalThis.setImmediate = patient as typeof setImmediate;
}
