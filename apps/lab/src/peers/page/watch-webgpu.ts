import type { ByteLedger } from './byte-ledger.ts';
import type { GpuTime } from './gpu-time.ts';
import { noteCalls, replaceMethod } from './replace-method.ts';
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
  noteCalls(GPUDevice.prototype, 'createBuffer', (_device, [{ size }], buffer) => ledger.set(buffer, size));
  noteCalls(GPUDevice.prototype, 'createTexture', (_device, _args, texture) =>
    ledger.set(texture, textureBytes(texture)),
  );
  noteCalls(GPUBuffer.prototype, 'destroy', (buffer) => ledger.delete(buffer));
  noteCalls(GPUTexture.prototype, 'destroy', (texture) => ledger.delete(texture));
  noteCalls(GPUCanvasContext.prototype, 'configure', ({ canvas }, [{ device }]) =>
    devices.set(canvas, device),
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
