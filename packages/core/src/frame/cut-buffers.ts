import type { Levels } from '../clouds/levels.ts';
import type { TouchedLinks } from '../clouds/touched-links.ts';
import { CutParameters, CutPlan, LEVEL_CONSTANTS } from '../data/layout/level-structs.ts';
import type { Bindings } from '../gpu/pipelines.ts';
import { pagesOf } from './frame-pages.ts';
import type { PartContext } from './frame-part.ts';
import type { FramePlan } from './frame-plan.ts';
import type { FrameShape } from './frame-shape.ts';

/** The buffers of the cut through one cloud's levels. */
interface Cut {
  readonly levels: Levels;
  readonly parameters: GPUBuffer;
  /** A word per cell. */
  readonly thresholds: GPUBuffer;
  /** Null where nothing is edited or selected. */
  touched: TouchedLinks | null;
}

/** Of the words that cut-count adds to. */
const COUNTS_BYTES = 4 * LEVEL_CONSTANTS.CUT_BINS * LEVEL_CONSTANTS.CUT_COPIES;

/** What a frame's cuts through levels of detail take; nothing for clouds drawn in full. */
export class CutBuffers {
  readonly #context: PartContext;
  #budget: { readonly cutPlan: GPUBuffer; readonly cutCounts: GPUBuffer } | null = null;
  /** By cloud of the frame. */
  #cuts: readonly (Cut | null)[] = [];

  constructor(context: PartContext) {
    this.#context = context;
  }

  /** Makes room for the cuts of this shape, and frees the rest. */
  fit({ clouds, isBudgeted, dispatchRow }: FrameShape): void {
    if (isBudgeted !== (this.#budget !== null)) this.#fitBudget();
    const kept = clouds.map(({ levels }, i) =>
      levels === (this.#cuts[i]?.levels ?? null) ? this.#cuts[i] : null,
    );
    for (const [i, cut] of this.#cuts.entries()) if (cut && cut !== kept[i]) this.#destroy(cut);
    this.#cuts = clouds.map(({ levels }, i) => kept[i] ?? (levels && this.#make(levels)));
    for (const [i, { isTouched }] of clouds.entries()) {
      const cut = this.#cuts[i];
      if (!cut || isTouched === (cut.touched !== null)) continue;
      cut.touched?.destroy();
      cut.touched = isTouched ? cut.levels.refinement!.make({ ...this.#context, dispatchRow }) : null;
    }
  }

  /** Returns the bindings of a cloud's cut, of a page with `links`; null without one. */
  bindingsOf(cloudIndex: number, links: GPUBuffer | null = null): Bindings | null {
    const cut = this.#cuts[cloudIndex];
    if (!cut) return null;
    const { levels, parameters, thresholds, touched } = cut;
    return {
      parameters,
      cells: (touched ?? levels).cells,
      thresholds,
      ...(links && { links: touched?.of(links) ?? links }),
      ...this.#budget,
    };
  }

  /** Bindings of the frame's budget; null without one. */
  get budgetBindings(): Readonly<Record<'cutPlan' | 'cutCounts', GPUBuffer>> | null {
    return this.#budget;
  }

  /** @param pages by page of the frame, with the bindings of its stages. */
  write({ clouds, shape, budget }: FramePlan, pages: readonly { readonly own: Bindings }[]): void {
    const { queue } = this.#context.device;
    if (this.#budget && budget) {
      const { leastShift: shift, splats } = budget;
      const values = { base: shift, step: LEVEL_CONSTANTS.SHIFT_STEP, shift, budget: splats };
      queue.writeBuffer(this.#budget.cutPlan, 0, CutPlan.pack(values));
    }
    for (const [i, cut] of this.#cuts.entries()) {
      if (!cut) continue;
      const { cellCount } = cut.levels;
      const values = { ...clouds[i].cut!, cellCount, dispatchRow: shape.dispatchRow };
      queue.writeBuffer(cut.parameters, 0, CutParameters.pack(values));
      cut.touched?.update(
        clouds[i],
        pages.filter((_, page) => pagesOf(shape)[page].cloudIndex === i),
      );
    }
  }

  #fitBudget(): void {
    const { STORAGE, COPY_DST, COPY_SRC } = GPUBufferUsage;
    const usage = STORAGE | COPY_DST | COPY_SRC;
    const { memory } = this.#context;
    if (this.#budget) for (const buffer of Object.values(this.#budget)) memory.destroy(buffer);
    this.#budget = this.#budget
      ? null
      : {
          cutPlan: memory.createBuffer('frame cut plan', CutPlan.bytes, usage),
          cutCounts: memory.createBuffer('frame cut counts', COUNTS_BYTES, usage),
        };
  }

  #make(levels: Levels): Cut {
    const { STORAGE, UNIFORM, COPY_DST, COPY_SRC } = GPUBufferUsage;
    const { memory } = this.#context;
    return {
      levels,
      parameters: memory.createBuffer('frame cut', CutParameters.bytes, UNIFORM | COPY_DST),
      thresholds: memory.createBuffer('frame thresholds', 4 * levels.cellCount, STORAGE | COPY_SRC),
      touched: null,
    };
  }

  #destroy({ parameters, thresholds, touched }: Cut): void {
    this.#context.memory.destroy(parameters);
    this.#context.memory.destroy(thresholds);
    touched?.destroy();
  }
}
