import { GpuMemory } from '../gpu/gpu-memory.ts';

/** Memory that runs out after a number of buffers, in itself and all of its parts together. */
export class ScarceMemory extends GpuMemory {
  buffersMade = 0;
  readonly #maxBuffers: number;
  readonly #whole: ScarceMemory | null;

  constructor(device: GPUDevice, maxBuffers: number, whole: ScarceMemory | null = null) {
    super(device, Number.POSITIVE_INFINITY, whole);
    this.#maxBuffers = maxBuffers;
    this.#whole = whole;
  }

  override part(): GpuMemory {
    return new ScarceMemory(this.device, this.#maxBuffers, this);
  }

  override createBuffer(...options: Parameters<GpuMemory['createBuffer']>): GPUBuffer {
    this.#count();
    return super.createBuffer(...options);
  }

  override createFilledBuffer(...options: Parameters<GpuMemory['createFilledBuffer']>): GPUBuffer {
    this.#count();
    return super.createFilledBuffer(...options);
  }

  #count(): void {
    if (this.#whole) {
      this.#whole.#count();
      return;
    }
    if (this.buffersMade === this.#maxBuffers) throw new Error('no more buffers');
    this.buffersMade++;
  }
}
