import { roundUp } from '../data/layout/gpu-struct.ts';
import type { GpuMemory } from '../gpu/gpu-memory.ts';
import type { Bindings } from '../gpu/pipelines.ts';
import { ChunkLevels } from './chunk-levels.ts';
import { pagesOf, UNIFORM_ALIGNMENT } from './frame-pages.ts';
import type { FramePlan } from './frame-plan.ts';
import type { FrameShape } from './frame-shape.ts';
import { SelectionBits } from './selection-bits.ts';

/** Parameters, selections and levels of the effects of a frame's clouds; empty if no effect takes any. */
export class EffectBuffers {
  readonly #memory: GpuMemory;
  readonly #queue: GPUQueue;
  readonly #selections: SelectionBits;
  readonly #levels: ChunkLevels;
  #parameters: GPUBuffer | null = null;
  #contents = new Uint8Array(0);
  /** From one cloud's parameters to the next cloud's. */
  #strideBytes = 0;

  constructor(memory: GpuMemory, queue: GPUQueue) {
    this.#memory = memory;
    this.#queue = queue;
    this.#selections = new SelectionBits(memory, queue);
    this.#levels = new ChunkLevels(memory, queue);
  }

  /** Makes room for the effects of this shape, and frees the rest. */
  fit(shape: FrameShape): void {
    this.#selections.fit(shape.clouds, pagesOf(shape));
    this.#levels.fit(shape.clouds, pagesOf(shape));
    this.#strideBytes = strideOf(shape);
    const bytes = this.#strideBytes * shape.clouds.length;
    if ((this.#parameters?.size ?? 0) === bytes) return;
    if (this.#parameters) this.#memory.destroy(this.#parameters);
    const usage = GPUBufferUsage.UNIFORM | GPUBufferUsage.COPY_DST;
    this.#parameters = bytes > 0 ? this.#memory.createBuffer('frame effects', bytes, usage) : null;
  }

  /** Returns the bindings of one page's stages. */
  bindingsOf(pageIndex: number, cloudIndex: number): Bindings {
    const selectedBits = this.#selections.bindingOf(pageIndex);
    const chunkLevels = this.#levels.bindingOf(pageIndex);
    const size = this.#strideBytes;
    return {
      ...(this.#parameters && { effects: { buffer: this.#parameters, offset: cloudIndex * size, size } }),
      ...(selectedBits && { selectedBits }),
      ...(chunkLevels && { chunkLevels }),
    };
  }

  write(plan: FramePlan): void {
    if (this.#parameters) {
      const { size } = this.#parameters;
      if (this.#contents.length !== size) this.#contents = new Uint8Array(size);
      for (const [i, { parameters }] of plan.clouds.entries())
        this.#contents.set(parameters, i * this.#strideBytes);
      this.#queue.writeBuffer(this.#parameters, 0, this.#contents);
    }
    this.#selections.write(plan.clouds);
    this.#levels.write();
  }

  /** Bytes of the levels of one cloud's chunks. */
  levelBytes(cloudIndex: number): number {
    return this.#levels.bytesOf(cloudIndex);
  }

  /** Bytes of one cloud's selection bits. */
  selectionBytes(cloudIndex: number): number {
    return this.#selections.bytesOf(cloudIndex);
  }
}

/** Returns 0 if no cloud's effects take parameters. */
function strideOf({ clouds }: FrameShape): number {
  return roundUp(Math.max(0, ...clouds.map(({ effects }) => effects.parameterBytes)), UNIFORM_ALIGNMENT);
}
