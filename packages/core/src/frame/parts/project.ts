import { maxColor } from '../../data/accuracy/accuracy.ts';
import { SPLAT_RECORDS } from '../../data/layout/structs.ts';
import type { GpuMemory } from '../../gpu/gpu-memory.ts';
import { type Dispatch, dispatchOf, ONE_WORKGROUP } from '../../gpu/passes.ts';
import type { CompiledStage } from '../../gpu/pipelines.ts';
import { compactSplats } from '../../stages/cull/cull.ts';
import { sizeAtMost } from '../../stages/dispatch.ts';
import { planProject, project } from '../../stages/project/project.ts';
import { wideKeys } from '../../stages/wide-keys/wide-keys.ts';
import { pagesOf, projectWorkgroups, totalChunks } from '../frame-pages.ts';
import { createBuffers, type FramePart, type PartChange, type PartContext } from '../frame-part.ts';
import type { FramePlan } from '../frame-plan.ts';
import { type FrameShape, hasSameBuffers, hasWideKeys } from '../frame-shape.ts';
import { pageStages } from '../page-stages.ts';
import { depthSortShape } from '../sort-shapes.ts';

const STAGES = pageStages((variant) => ({
  project: project({
    ...variant,
    shortKeyBits: variant.shortensKeys ? variant.accuracy.sortKeyBits : null,
    maxColor: maxColor(variant.accuracy),
    storedShDegree: variant.cloud.shDegree,
  }),
  wideKeys: hasWideKeys(variant) ? wideKeys(variant) : null,
}));

/** Lists the visible splats in storage order, and writes the record and the sort key of each. */
export class Project implements FramePart {
  dispatches: readonly Dispatch[] = [];
  /** Writes the records alone, of the visible splats of the last frame. */
  records: readonly Dispatch[] = [];
  readonly #context: PartContext;
  readonly #memory: GpuMemory;
  /** The shape that the buffers were made for. */
  #shape: FrameShape | null = null;

  constructor(context: PartContext) {
    this.#context = context;
    this.#memory = context.memory.part();
  }

  static stages(shape: FrameShape): readonly CompiledStage[] {
    return [planProject(depthSortShape(shape)), compactSplats, ...STAGES.all(shape)];
  }

  fit({ shape }: FramePlan): PartChange | null {
    if (this.#shape && hasSameBuffers(this.#shape, shape)) return null;
    const { accuracy, visibleCapacity } = shape;
    const { STORAGE, INDIRECT } = GPUBufferUsage;
    const table = {
      projectDispatches: [12 * (pagesOf(shape).length + 1), STORAGE | INDIRECT],
      drawArguments: [16, STORAGE | INDIRECT],
      records: [SPLAT_RECORDS[accuracy.recordPrecision].bytes * Math.max(1, visibleCapacity), STORAGE],
    } as const;
    // The largest buffer of a frame, besides the pairs', whose number is limited.
    this.#memory.check('frame records', ...table.records);
    return {
      free: () => this.#memory.destroyAll(),
      make: () => {
        Object.assign(this.#context.shared.buffers, createBuffers(this.#memory, 'frame', table));
        this.#shape = shape;
      },
    };
  }

  bind(shape: FrameShape): void {
    const { pipelines, shared } = this.#context;
    const { projectDispatches, cullDispatches } = shared.buffers;
    const { dispatchRow, sortDevice } = shape;
    const { isNarrow } = sortDevice;
    const pages = pagesOf(shape);
    const overPages = (name: 'project' | 'wideKeys') =>
      pages.flatMap((page, index) => {
        const stage = STAGES.of(shape, page)[name];
        const indirect = { buffer: projectDispatches, offset: 12 * index };
        const size = sizeAtMost(projectWorkgroups(page.chunkCount), dispatchRow, indirect, isNarrow);
        return stage ? [dispatchOf(pipelines, stage, shared.pages[index], size)] : [];
      });
    const visibleChunks = { buffer: cullDispatches, offset: 12 * pages.length };
    const overSlots = sizeAtMost(totalChunks(pages), dispatchRow, visibleChunks, isNarrow);
    this.records = overPages('project');
    this.dispatches = [
      dispatchOf(pipelines, planProject(depthSortShape(shape)), shared.buffers, ONE_WORKGROUP),
      dispatchOf(pipelines, compactSplats, shared.buffers, overSlots),
      ...this.records,
      ...overPages('wideKeys'),
    ];
  }
}
