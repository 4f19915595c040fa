import type { RowTextures, SplatEffect } from '../../gpu/effects/effect.ts';
import { rowsOf } from '../../gpu/effects/effect-set.ts';
import type { GpuMemory } from '../../gpu/gpu-memory.ts';
import type { Bindings } from '../../gpu/pipelines.ts';
import { pagesOf, type UniformRange, uniformBytes } from '../frame-pages.ts';
import type { FramePlan } from '../plan/frame-plan.ts';
import type { FrameShape } from '../plan/frame-shape.ts';
import { ChunkLevels } from './chunk-levels.ts';
import { SelectionBits } from './selection-bits.ts';

/** Parameters, selections, levels and rows of the effects of a frame's clouds; empty if no effect takes any. */
export class EffectBuffers {
  readonly #memory: GpuMemory;
  readonly #queue: GPUQueue;
  readonly #selections: SelectionBits;
  readonly #levels: ChunkLevels;
  /** Undefined until an effect takes rows: their code comes with such effects. */
  #rows: RowTextures | undefined;
  #parameters: GPUBuffer | null = null;
  #contents = new Uint8Array(0);
  /** By page of the frame. */
  #ranges: readonly UniformRange[] = [];

  constructor(memory: GpuMemory, queue: GPUQueue) {
    this.#memory = memory;
    this.#queue = queue;
    this.#selections = new SelectionBits(memory, queue);
    this.#levels = new ChunkLevels(memory, queue);
  }

  /** Makes room for the effects of this shape, and frees the rest. */
  fit(shape: FrameShape): void {
    const pages = pagesOf(shape);
    this.#selections.fit(shape.clouds, pages);
    this.#levels.fit(shape.clouds, pages);
    for (const { effects } of shape.clouds)
      this.#rows ??= rowsOf(effects)?.texturesIn(this.#memory, this.#queue);
    this.#rows?.fit(shape.clouds, pages);
    this.#ranges = pages.map(({ parameters }) => parameters);
    const bytes = uniformBytes(this.#ranges);
    if ((this.#parameters?.size ?? 0) === bytes) return;
    if (this.#parameters) this.#memory.destroy(this.#parameters);
    const usage = GPUBufferUsage.UNIFORM | GPUBufferUsage.COPY_DST;
    this.#parameters = bytes > 0 ? this.#memory.createBuffer('frame effects', bytes, usage) : null;
  }

  /** Returns the bindings of one page's stages. */
  bindingsOf(pageIndex: number): Bindings {
    const selectedBits = this.#selections.bindingOf(pageIndex);
    const chunkLevels = this.#levels.bindingOf(pageIndex);
    const range = this.#ranges[pageIndex];
    return {
      ...(this.#parameters && range.size > 0 && { effects: { buffer: this.#parameters, ...range } }),
      ...(selectedBits && { selectedBits }),
      ...(chunkLevels && { chunkLevels }),
      ...this.#rows?.bindingsOf(pageIndex),
    };
  }

  write(plan: FramePlan): void {
    if (this.#parameters) {
      const { size } = this.#parameters;
      if (this.#contents.length !== size) this.#contents = new Uint8Array(size);
      for (const {
        cloudIndex,
        instances,
        parameters: { offset },
      } of pagesOf(plan.shape)) {
        const { effects, parameters } = plan.clouds[cloudIndex];
        const { first, count } = instances ?? { first: 0, count: 1 };
        const bytes = effects.parameterBytes;
        this.#contents.set(parameters.subarray(first * bytes, (first + count) * bytes), offset);
      }
      this.#queue.writeBuffer(this.#parameters, 0, this.#contents);
    }
    this.#selections.write(plan.clouds);
    this.#levels.write();
    this.#rows?.write();
  }

  /** Bytes of all that an effect takes for one cloud, besides its parameters. */
  bytesOf({ takesSelection, takesLevel, rows }: SplatEffect, cloudIndex: number): number {
    return (
      (takesSelection ? this.#selections.bytesOf(cloudIndex) : 0) +
      (takesLevel ? this.#levels.bytesOf(cloudIndex) : 0) +
      (rows ? this.#rows!.bytesOf(cloudIndex) : 0)
    );
  }
}
