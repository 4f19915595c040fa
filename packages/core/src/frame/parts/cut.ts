import { type Dispatch, dispatchOf, ONE_WORKGROUP } from '../../gpu/passes.ts';
import type { CompiledStage } from '../../gpu/pipelines.ts';
import {
  countsInWindow,
  countWorkgroups,
  cutCells,
  cutCount,
  planCut,
  shiftCells,
} from '../../stages/cut/cut.ts';
import { dispatchSize } from '../../stages/dispatch.ts';
import type { CutBuffers } from '../cut-buffers.ts';
import { pagesOf, sizeOverChunks } from '../frame-pages.ts';
import type { FramePart, PartContext } from '../frame-part.ts';
import type { FrameShape } from '../frame-shape.ts';
import { pageStages } from '../page-stages.ts';

const STAGES = pageStages((variant) => ({
  cutCells: variant.hasLevels ? cutCells(variant.batchInstances ?? 1) : null,
  cutCount: variant.isBudgeted ? cutCount(variant) : null,
  shiftCells: variant.isBudgeted ? shiftCells(variant.batchInstances ?? 1) : null,
}));

/**
 * Finds the thresholds of the cuts through clouds' levels, and shifts them until the frame keeps
 * its budget. Runs nothing over clouds that are drawn in full.
 */
export class Cut implements FramePart {
  dispatches: readonly Dispatch[] = [];
  readonly #context: PartContext;
  readonly #buffers: CutBuffers;

  constructor(context: PartContext, buffers: CutBuffers) {
    this.#context = context;
    this.#buffers = buffers;
  }

  static stages(shape: FrameShape): readonly CompiledStage[] {
    const touched = shape.clouds.flatMap(({ isTouched, levels }) =>
      isTouched ? levels!.refinement!.stages : [],
    );
    return [...STAGES.all(shape), ...(shape.isBudgeted ? [planCut] : []), ...touched];
  }

  /** One `CutPlan`; null where no budget limits the frame. */
  get cutPlan(): GPUBuffer | null {
    return this.#buffers.budgetBindings?.cutPlan ?? null;
  }

  bind(shape: FrameShape): void {
    const { pipelines, shared } = this.#context;
    const overCells = (name: 'cutCells' | 'shiftCells') =>
      shape.clouds.flatMap((_, cloudIndex) =>
        this.#buffers.batchesOf(cloudIndex).map(({ own, thresholdCount }) => {
          const stage = STAGES.of(shape, { cloudIndex, isBlobs: false })[name]!;
          return dispatchOf(pipelines, stage, own, sizeOverChunks(thresholdCount, shape));
        }),
      );
    this.dispatches = overCells('cutCells');
    const budget = this.#buffers.budgetBindings;
    if (!budget) return;
    const counts = pagesOf(shape).flatMap((page, index) => {
      const stage = STAGES.of(shape, page).cutCount;
      const size = dispatchSize(countWorkgroups(page.chunkCount, shape.sortDevice), shape.dispatchRow);
      return stage ? [dispatchOf(pipelines, stage, shared.pages[index], size)] : [];
    });
    const plan = dispatchOf(pipelines, planCut, budget, ONE_WORKGROUP);
    const count = [...counts, plan];
    const again = countsInWindow(shape.sortDevice) ? count : [];
    this.dispatches = [...this.dispatches, ...count, ...again, ...overCells('shiftCells')];
  }
}
