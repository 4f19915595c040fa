import type { CloudLevels } from '../clouds/cloud-levels.ts';
import { CutParameters, CutPlan, LEVEL_CONSTANTS } from '../data/layout/level-structs.ts';
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

/** Of the words that cut-count adds to. */
const COUNTS_BYTES = 4 * LEVEL_CONSTANTS.CUT_BINS * LEVEL_CONSTANTS.CUT_COPIES;

/** What a frame's cuts through levels of detail take; nothing for clouds drawn in full. */
export class CutBuffers {
  readonly #memory: GpuMemory;
  readonly #queue: GPUQueue;
  #budget: { readonly cutPlan: GPUBuffer; readonly cutCounts: GPUBuffer } | null = null;
  /** By cloud of the frame. */
  #cuts: readonly (Cut | null)[] = [];

  constructor(memory: GpuMemory, queue: GPUQueue) {
    this.#memory = memory;
    this.#queue = queue;
  }

  /** Makes room for the cuts of this shape, and frees the rest. */
  fit({ clouds, isBudgeted }: FrameShape): void {
    if (isBudgeted !== (this.#budget !== null)) this.#fitBudget();
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
    return { parameters, cells: levels.cells, thresholds, ...this.#budget };
  }

  /** Bindings of the frame's budget; null without one. */
  get budgetBindings(): Bindings | null {
    return this.#budget;
  }

  write({ clouds, shape, budget }: FramePlan): void {
    if (this.#budget && budget) {
      const { leastShift: shift, splats } = budget;
      const values = { base: shift, step: LEVEL_CONSTANTS.SHIFT_STEP, shift, budget: splats };
      this.#queue.writeBuffer(this.#budget.cutPlan, 0, CutPlan.pack(values));
    }
    for (const [i, cut] of this.#cuts.entries()) {
      if (!cut) continue;
      const { cellCount } = cut.levels;
      const values = { ...clouds[i].cut!, cellCount, dispatchRow: shape.dispatchRow };
      this.#queue.writeBuffer(cut.parameters, 0, CutParameters.pack(values));
    }
  }

  #fitBudget(): void {
    const { STORAGE, COPY_DST, COPY_SRC } = GPUBufferUsage;
    const usage = STORAGE | COPY_DST | COPY_SRC;
    if (this.#budget) for (const buffer of Object.values(this.#budget)) this.#memory.destroy(buffer);
    this.#budget = this.#budget
      ? null
      : {
          cutPlan: this.#memory.createBuffer('frame cut plan', CutPlan.bytes, usage),
          cutCounts: this.#memory.createBuffer('frame cut counts', COUNTS_BYTES, usage),
        };
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
