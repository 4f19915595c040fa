import { GpuMemory } from '../gpu/gpu-memory.ts';

/** Memory that runs out after a number of buffers. */
export class ScarceMemory extends GpuMemory {
  buffersMade = 0;
  readonly #maxBuffers: number;

  constructor(device: GPUDevice, maxBuffers: number) {
    super(device);
    this.#maxBuffers = maxBuffers;
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
    if (this.buffersMade === this.#maxBuffers) throw new Error('no more buffers');
    this.buffersMade++;
  }
}
