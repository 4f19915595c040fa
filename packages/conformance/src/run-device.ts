import {
  type AccuracyPreset,
  requestSplatDevice,
  type SplatEngine,
  WebGpuUnavailableError,
} from '@websplatter/core';
import { createEngine, Pipelines, type ShaderMutation } from '@websplatter/core/inspect';

/** Deviations of an engine or a set of pipelines from the defaults. */
export interface RunVariant {
  /** Most workgroups in one dimension of a dispatch; default the device's limit. */
  readonly maxWorkgroupsPerDimension?: number;
  /** A remedy of the shaders to switch off, for tests that the cases notice it. */
  readonly mutation?: ShaderMutation;
}

/** @throws WebGpuUnavailableError if there is none. */
export async function requestAdapter(gpu: Pick<GPU, 'requestAdapter'>): Promise<GPUAdapter> {
  const adapter = await gpu.requestAdapter({ powerPreference: 'high-performance' });
  if (!adapter) throw new WebGpuUnavailableError('WebGPU is available but found no GPU that it may use.');
  return adapter;
}

/** A device that records its errors and loss, with its engines: cases share its pipelines. */
export class WatchedDevice {
  readonly device: GPUDevice;
  readonly #errors: string[] = [];
  readonly #engines = new Map<string, Promise<SplatEngine>>();
  readonly #pipelines = new Map<ShaderMutation | undefined, Pipelines>();
  #isClosing = false;
  #isLost = false;

  constructor(device: GPUDevice) {
    this.device = device;
    device.addEventListener('uncapturederror', (event) => {
      event.preventDefault();
      this.#errors.push(`${event.error.constructor.name}: ${event.error.message}`);
    });
    void device.lost.then(({ reason, message }) => {
      this.#isLost = true;
      if (!this.#isClosing) this.#errors.push(`the device was lost (${reason}): ${message}`);
    });
  }

  /**
   * Requests an adapter and its device.
   *
   * @throws WebGpuUnavailableError if there is none.
   */
  static async request(gpu: Pick<GPU, 'requestAdapter'>): Promise<WatchedDevice> {
    return new WatchedDevice(await requestSplatDevice({ adapter: await requestAdapter(gpu) }));
  }

  /** Whether the device is lost and must be replaced. */
  get isLost(): boolean {
    return this.#isLost;
  }

  /** Returns the engine of a preset. Cases share it: destroy your additions to it. */
  engine(
    accuracy: AccuracyPreset,
    { maxWorkgroupsPerDimension, mutation }: RunVariant,
  ): Promise<SplatEngine> {
    const key = JSON.stringify([accuracy, maxWorkgroupsPerDimension, mutation]);
    const { device } = this;
    const made =
      this.#engines.get(key) ?? createEngine({ device, accuracy }, { maxWorkgroupsPerDimension, mutation });
    this.#engines.set(key, made);
    return made;
  }

  pipelines({ mutation }: RunVariant): Pipelines {
    const made = this.#pipelines.get(mutation) ?? new Pipelines(this.device, mutation);
    this.#pipelines.set(mutation, made);
    return made;
  }

  dispatchRow({ maxWorkgroupsPerDimension }: RunVariant): number {
    const limit = this.device.limits.maxComputeWorkgroupsPerDimension;
    return Math.min(limit, maxWorkgroupsPerDimension ?? limit);
  }

  /** Waits for all submitted work; returns the device's errors since the last call. */
  async takeErrors(): Promise<string[]> {
    // A lost device may reject; its loss is in `#errors`.
    await Promise.race([this.device.queue.onSubmittedWorkDone(), this.device.lost]).catch(() => {});
    return this.#errors.splice(0);
  }

  destroy(): void {
    this.#isClosing = true;
    this.device.destroy();
  }
}
