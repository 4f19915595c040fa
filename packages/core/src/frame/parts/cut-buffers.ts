import type { Levels } from '../../clouds/levels/levels.ts';
import type { TouchedLinks } from '../../clouds/levels/touched-links.ts';
import { hasSameFields } from '../../data/has-same-fields.ts';
import { roundUp } from '../../data/layout/gpu-struct.ts';
import { CutParameters, CutPlan, LEVEL_CONSTANTS } from '../../data/layout/level-structs.ts';
import type { Bindings } from '../../gpu/pipelines.ts';
import { countsInWindow } from '../../stages/cut/cut.ts';
import { type Batch, BINDING_ALIGNMENT, batchesOf, type FramePage } from '../frame-pages.ts';
import type { FramePlan } from '../plan/frame-plan.ts';
import type { FrameShape } from '../plan/frame-shape.ts';
import type { PartContext, StageTarget } from './frame-part.ts';

/** The buffers of the cuts through one cloud's levels. */
interface Cut {
  readonly levels: Levels;
  readonly batches: readonly Batch[];
  /** A `CutParameters` for each instance, batch by batch. */
  readonly cuts: GPUBuffer;
  /** A word for each cell of each instance, batch by batch. */
  readonly thresholds: GPUBuffer;
  /** Null where nothing is edited or selected. */
  touched: TouchedLinks | null;
}

/** Of the words that cut-count adds to. */
const COUNTS_BYTES = 4 * LEVEL_CONSTANTS.CUT_BINS * LEVEL_CONSTANTS.CUT_COPIES;

/** Buffers of a frame's LOD cuts; none for clouds drawn in full. */
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
    const batches = clouds.map(batchesOf);
    const kept = clouds.map(({ levels }, i) => {
      const cut = this.#cuts[i];
      return cut && cut.levels === levels && isSameBatches(cut.batches, batches[i]) ? cut : null;
    });
    for (const [i, cut] of this.#cuts.entries()) if (cut && cut !== kept[i]) this.#destroy(cut);
    this.#cuts = clouds.map(({ levels }, i) => kept[i] ?? (levels && this.#make(levels, batches[i])));
    for (const [i, { isTouched }] of clouds.entries()) {
      const cut = this.#cuts[i];
      if (!cut || isTouched === (cut.touched !== null)) continue;
      cut.touched?.destroy();
      cut.touched = isTouched ? cut.levels.refinement!.make({ ...this.#context, dispatchRow }) : null;
    }
  }

  /** The batches of all clouds that are cut. */
  batches({ clouds }: FrameShape): StageTarget[] {
    return clouds.flatMap((_, cloudIndex) => {
      const cut = this.#cuts[cloudIndex];
      if (!cut) return [];
      return cut.batches.map(({ count }, batch) => ({
        cloudIndex,
        isBlobs: false,
        count: count * cut.levels.cellCount,
        resources: this.#bindingsOf(cut, batch),
      }));
    });
  }

  /** Returns the bindings of a page's cut; null without one. */
  bindingsOf({ cloudIndex, batchIndex, links }: FramePage): Bindings | null {
    const cut = this.#cuts[cloudIndex];
    if (!cut || !links) return null;
    return { ...this.#bindingsOf(cut, batchIndex), links: cut.touched?.of(links) ?? links };
  }

  #bindingsOf({ levels, batches, cuts, thresholds, touched }: Cut, batch: number): Bindings {
    const { count, places } = batches[batch];
    const offset = batch * thresholdStride(levels, batches);
    return {
      cuts: { buffer: cuts, offset: batch * cutStride(batches), size: CutParameters.bytes * places },
      cells: (touched ?? levels).cells,
      thresholds: { buffer: thresholds, offset, size: 4 * levels.cellCount * count },
      ...this.#budget,
    };
  }

  write({ clouds, shape, budget }: FramePlan, pages: readonly StageTarget[]): void {
    const { queue } = this.#context.device;
    if (this.#budget && budget) {
      const contents = CutPlan.pack({
        leastShift: Math.max(budget.leastShift, LEVEL_CONSTANTS.LEAST_SHIFT),
        budget: budget.splats,
        ...{ base: 0, shift: 0, next: LEVEL_CONSTANTS.COUNT_ANEW },
      });
      // A count in a window begins where the last frame's plan left `base`.
      const bytes = countsInWindow(shape.sortDevice) ? CutPlan.offsets.base : CutPlan.bytes;
      queue.writeBuffer(this.#budget.cutPlan, 0, contents, 0, bytes);
    }
    for (const [i, cut] of this.#cuts.entries()) {
      if (!cut) continue;
      const { batches, cuts, levels } = cut;
      const contents = new ArrayBuffer(cuts.size);
      const stride = cutStride(batches);
      const { places, cut: own } = clouds[i];
      for (const [batch, { first, count }] of batches.entries()) {
        for (let instance = 0; instance < count; instance++) {
          const values = {
            ...(places ? places[first + instance].cut! : own!),
            cellCount: levels.cellCount,
            dispatchRow: shape.dispatchRow,
          };
          CutParameters.write(contents, values, batch * stride + instance * CutParameters.bytes);
        }
      }
      queue.writeBuffer(cuts, 0, contents);
      cut.touched?.update(
        clouds[i],
        pages
          .filter(({ cloudIndex }) => cloudIndex === i)
          .map(({ resources, effects }) => ({ ...resources, ...effects })),
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
    Object.assign(this.#context.shared.resources, this.#budget ?? { cutPlan: null, cutCounts: null });
  }

  #make(levels: Levels, batches: readonly Batch[]): Cut {
    const { STORAGE, UNIFORM, COPY_DST, COPY_SRC } = GPUBufferUsage;
    const { memory } = this.#context;
    const cutBytes = batches.length * cutStride(batches);
    const thresholdBytes = batches.length * thresholdStride(levels, batches);
    return {
      levels,
      batches,
      cuts: memory.createBuffer('frame cuts', cutBytes, UNIFORM | COPY_DST),
      thresholds: memory.createBuffer('frame thresholds', thresholdBytes, STORAGE | COPY_SRC),
      touched: null,
    };
  }

  #destroy({ cuts, thresholds, touched }: Cut): void {
    this.#context.memory.destroy(cuts);
    this.#context.memory.destroy(thresholds);
    touched?.destroy();
  }
}

/** Bytes between the parameters of successive batches. */
function cutStride([{ places }]: readonly Batch[]): number {
  return roundUp(CutParameters.bytes * places, BINDING_ALIGNMENT);
}

/** Bytes between the thresholds of successive batches; the first batch has the most instances. */
function thresholdStride({ cellCount }: Levels, batches: readonly Batch[]): number {
  const bytes = 4 * cellCount * batches[0].count;
  return batches.length === 1 ? bytes : roundUp(bytes, BINDING_ALIGNMENT);
}

function isSameBatches(a: readonly Batch[], b: readonly Batch[]): boolean {
  return a.length === b.length && a.every((batch, i) => hasSameFields(batch, b[i]));
}
