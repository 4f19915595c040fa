import type { CloudLevels } from '../clouds/cloud-levels.ts';
import { CutParameters } from '../data/layout/level-structs.ts';
import type { GpuMemory } from '../gpu/gpu-memory.ts';
import type { Bindings } from '../gpu/pipelines.ts';
import type { FramePlan } from './frame-plan.ts';
import type { FrameShape } from './frame-shape.ts';

/** The buffers of the cut through one cloud's levels. */
interface Cut {
  readonly levels: CloudLevels;
  readonly parameters: GPUBuffer;
  /** A word per cell. */
  readonly thresholds: GPUBuffer;
}

/** What a frame's cuts through levels of detail take; nothing for clouds drawn in full. */
export class CutBuffers {
  readonly #memory: GpuMemory;
  readonly #queue: GPUQueue;
  /** By cloud of the frame. */
  #cuts: readonly (Cut | null)[] = [];

  constructor(memory: GpuMemory, queue: GPUQueue) {
    this.#memory = memory;
    this.#queue = queue;
  }

  /** Makes room for the cuts of this shape, and frees the rest. */
  fit({ clouds }: FrameShape): void {
    const kept = clouds.map(({ levels }, i) =>
      levels === (this.#cuts[i]?.levels ?? null) ? this.#cuts[i] : null,
    );
    for (const [i, cut] of this.#cuts.entries()) if (cut && cut !== kept[i]) this.#destroy(cut);
    this.#cuts = clouds.map(({ levels }, i) => kept[i] ?? (levels && this.#make(levels)));
  }

  /** Returns the bindings of a cloud's cut; null without one. */
  bindingsOf(cloudIndex: number): Bindings | null {
    const cut = this.#cuts[cloudIndex];
    if (!cut) return null;
    const { levels, parameters, thresholds } = cut;
    return { parameters, cells: levels.cells, thresholds };
  }

  write({ clouds, shape }: FramePlan): void {
    for (const [i, cut] of this.#cuts.entries()) {
      if (!cut) continue;
      const { cellCount } = cut.levels;
      const values = { ...clouds[i].cut!, cellCount, dispatchRow: shape.dispatchRow };
      this.#queue.writeBuffer(cut.parameters, 0, CutParameters.pack(values));
    }
  }

  #make(levels: CloudLevels): Cut {
    const { STORAGE, UNIFORM, COPY_DST, COPY_SRC } = GPUBufferUsage;
    return {
      levels,
      parameters: this.#memory.createBuffer('frame cut', CutParameters.bytes, UNIFORM | COPY_DST),
      thresholds: this.#memory.createBuffer('frame thresholds', 4 * levels.cellCount, STORAGE | COPY_SRC),
    };
  }

  #destroy({ parameters, thresholds }: Cut): void {
    this.#memory.destroy(parameters);
    this.#memory.destroy(thresholds);
  }
}
