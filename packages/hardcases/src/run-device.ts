import { type AccuracyPreset, SplatEngine } from '@websplatter/core';
import { Pipelines, type ShaderMutation } from '@websplatter/core/inspect';

/** How an engine or a set of pipelines differs from the usual. */
export interface RunVariant {
  /** Most workgroups in one dimension of a dispatch; default the device's limit. */
  readonly maxWorkgroupsPerDimension?: number;
  /** For tests that the cases notice: a remedy of the shaders switched off. */
  readonly mutation?: ShaderMutation;
}

/** A device whose errors and loss are noted, with the engines on it: what is compiled serves all cases. */
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

  /** Whether another device has to take over. */
  get isLost(): boolean {
    return this.#isLost;
  }

  /** The engine of a preset; shared, so what is added to it is to be destroyed again. */
  engine(
    accuracy: AccuracyPreset,
    { maxWorkgroupsPerDimension, mutation }: RunVariant,
  ): Promise<SplatEngine> {
    const key = JSON.stringify([accuracy, maxWorkgroupsPerDimension, mutation]);
    const { device } = this;
    const made =
      this.#engines.get(key) ?? SplatEngine.create({ device, accuracy, maxWorkgroupsPerDimension, mutation });
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

  /** Errors since the last call, when all that was submitted is done: they arrive with the device's answers. */
  async takeErrors(): Promise<string[]> {
    await Promise.race([this.device.queue.onSubmittedWorkDone(), this.device.lost]).catch(() => {});
    return this.#errors.splice(0);
  }

  destroy(): void {
    this.#isClosing = true;
    this.device.destroy();
  }
}
