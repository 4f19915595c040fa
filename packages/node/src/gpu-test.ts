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
 * Returns a device for tests. Any validation error, other uncaptured error or loss fails the test
 * in which it happens. The end of the file destroys it, if the tests have not.
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
 * The same for tests that destroy their device when they are done with it: they take turns with
 * others of their process, so that SwiftShader compiles the same shaders only once.
 */
export async function shareTestDevice(options: GPUDeviceDescriptor = {}): Promise<GPUDevice> {
  const { adapter } = await createNodeGpu();
  const device = await lendDevice(adapter, options);
  watchDevice(device);
  return device;
}

/** The same, with float32 blending where the adapter has it, as `reference` asks for. */
export async function shareBlendingDevice(): Promise<GPUDevice> {
  const { adapter } = await createNodeGpu();
  const blendable = 'float32-blendable' as GPUFeatureName;
  return shareTestDevice({ requiredFeatures: adapter.features.has(blendable) ? [blendable] : [] });
}

/** WebGPU whose adapters give such devices, which are not watched. */
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

/** Time between two questions whether the GPU is done, ms. */
const POLL_MS = 0.2;

/**
 * Makes `setImmediate` sleep first. In each turn of the event loop Dawn asks whether the GPU is
 * done, and by `setImmediate` for the next turn, which takes all of one core; software adapters
 * need that core for the work itself.
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
