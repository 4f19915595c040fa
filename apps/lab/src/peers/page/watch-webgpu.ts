import type { ByteLedger } from './byte-ledger.ts';
import type { GpuTime } from './gpu-time.ts';
import { replaceMethod } from './replace-method.ts';
import { textureBytes } from './texture-bytes.ts';

/** A GPU process that has just started may have no adapter yet: seen on an NVIDIA H200. */
const ADAPTER_ATTEMPTS = 20;
const BETWEEN_ATTEMPTS_MS = 250;

export interface WebGpuWatch {
  /** Device that draws to `canvas`. */
  deviceOf(canvas: HTMLCanvasElement): GPUDevice | undefined;
  /** Adapter of the newest device, in words. */
  adapter(): string | null;
  /** Called after each submission. */
  afterSubmit: (() => void) | null;
  /** Times submissions. */
  gpuTime: GpuTime | null;
}

/** Wraps WebGPU: counts bytes, reports errors to `complain`, and knows which device draws where. */
export function watchWebGpu(ledger: ByteLedger, complain: (problem: string) => void): WebGpuWatch {
  const devices = new WeakMap<HTMLCanvasElement | OffscreenCanvas, GPUDevice>();
  let adapterName: string | null = null;
  const watch: WebGpuWatch = {
    deviceOf: (canvas) => devices.get(canvas),
    adapter: () => adapterName,
    afterSubmit: null,
    gpuTime: null,
  };
  if (!('GPU' in globalThis)) return watch;

  replaceMethod(
    GPU.prototype,
    'requestAdapter',
    (requestAdapter) =>
      async function (this: GPU, options) {
        for (let attempt = 1; attempt < ADAPTER_ATTEMPTS; attempt++) {
          const adapter = await requestAdapter.call(this, options);
          if (adapter) return adapter;
          await new Promise((resolve) => setTimeout(resolve, BETWEEN_ATTEMPTS_MS));
        }
        return requestAdapter.call(this, options);
      },
  );
  replaceMethod(
    GPUAdapter.prototype,
    'requestDevice',
    (requestDevice) =>
      async function (this: GPUAdapter, descriptor = {}) {
        const requiredFeatures = [...(descriptor.requiredFeatures ?? [])];
        if (this.features.has('timestamp-query')) requiredFeatures.push('timestamp-query');
        const device = await requestDevice.call(this, { ...descriptor, requiredFeatures });
        const { vendor, architecture, description } = this.info;
        adapterName = description || `${vendor} ${architecture}`.trim();
        device.addEventListener('uncapturederror', ({ error }) => complain(`WebGPU: ${error.message}`));
        device.lost.then(({ reason, message }) => complain(`device lost: ${reason} ${message}`));
        return device;
      },
  );
  replaceMethod(
    GPUDevice.prototype,
    'createBuffer',
    (createBuffer) =>
      function (this: GPUDevice, descriptor) {
        const buffer = createBuffer.call(this, descriptor);
        ledger.set(buffer, descriptor.size);
        return buffer;
      },
  );
  replaceMethod(
    GPUDevice.prototype,
    'createTexture',
    (createTexture) =>
      function (this: GPUDevice, descriptor) {
        const texture = createTexture.call(this, descriptor);
        ledger.set(texture, textureBytes(texture));
        return texture;
      },
  );
  for (const prototype of [GPUBuffer.prototype, GPUTexture.prototype])
    replaceMethod(
      prototype,
      'destroy',
      (destroy) =>
        function (this: object) {
          ledger.delete(this);
          return destroy.call(this as never);
        },
    );
  replaceMethod(
    GPUCanvasContext.prototype,
    'configure',
    (configure) =>
      function (this: GPUCanvasContext, configuration) {
        devices.set(this.canvas, configuration.device);
        return configure.call(this, configuration);
      },
  );
  replaceMethod(
    GPUQueue.prototype,
    'submit',
    (submit) =>
      function (this: GPUQueue, commands) {
        submit.call(this, watch.gpuTime?.around(this, commands) ?? commands);
        watch.afterSubmit?.();
        return undefined;
      },
  );
  return watch;
}
