import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { CullParameters, PagePlan } from '../../data/layout/structs.ts';
import type { GpuMemory } from '../../gpu/gpu-memory.ts';
import { type Dispatch, dispatchOf, ONE_WORKGROUP } from '../../gpu/passes.ts';
import type { CompiledStage } from '../../gpu/pipelines.ts';
import { cullChunks, cullSplats, planCull } from '../../stages/cull/cull.ts';
import { cutSplats, cutWorkgroups } from '../../stages/cut/cut.ts';
import { sizeAtMost } from '../../stages/dispatch.ts';
import { type FramePage, pagesOf, sizeOverChunks, totalChunks } from '../frame-pages.ts';
import {
  createBuffers,
  type FramePart,
  type PartChange,
  type PartContext,
  type SharedBuffers,
} from '../frame-part.ts';
import type { FramePlan } from '../frame-plan.ts';
import { type FrameShape, hasSameBuffers } from '../frame-shape.ts';
import { pageStages } from '../page-stages.ts';

const STAGES = pageStages((variant) => ({
  cullChunks: cullChunks(variant),
  cutSplats: variant.hasLevels ? cutSplats(variant.batchInstances) : null,
  cullSplats: cullSplats(variant),
}));

/** Names, sizes and usages of the part's buffers; stages bind them by these names. */
function bufferTable({ visibleCapacity }: FrameShape, pages: readonly FramePage[]) {
  const [pageCount, chunkCount] = [pages.length, totalChunks(pages)];
  const { STORAGE, UNIFORM, INDIRECT } = GPUBufferUsage;
  return {
    cullParameters: [CullParameters.bytes, UNIFORM],
    /** Per chunk: 1 if it is visible; after plan-cull, the number of visible chunks before it. */
    chunkOffsets: [4 * (chunkCount + 1), STORAGE],
    visibleChunks: [4 * chunkCount, STORAGE],
    /** Number of visible chunks: each has a slot, numbered in storage order. */
    slotCount: [4, STORAGE],
    /** Per slot: a bit per splat. */
    visibilityMasks: [(CHUNK_SPLATS / 8) * chunkCount, STORAGE],
    /** Per slot: its number of visible splats; after plan-project, the sum of all earlier slots. */
    splatOffsets: [4 * (chunkCount + 1), STORAGE],
    // A binding holds at least one element, even if there is nothing to draw.
    pagePlans: [PagePlan.bytes * Math.max(1, pageCount), STORAGE],
    depthRange: [8, STORAGE | UNIFORM],
    cullDispatches: [12 * (pageCount + 1), STORAGE | INDIRECT],
    /** The visible splats in storage order. */
    visibleSplats: [4 * visibleCapacity, STORAGE],
  } as const satisfies Partial<
    Record<keyof SharedBuffers, readonly [bytes: number, usage: GPUBufferUsageFlags]>
  >;
}

/** Finds the visible chunks, which it lists in storage order, then their visible splats. */
export class Cull implements FramePart {
  dispatches: readonly Dispatch[] = [];
  readonly #context: PartContext;
  readonly #memory: GpuMemory;
  /** The shape that the buffers were made for. */
  #shape: FrameShape | null = null;

  constructor(context: PartContext) {
    this.#context = context;
    this.#memory = context.memory.part();
  }

  static stages(shape: FrameShape): readonly CompiledStage[] {
    return [...STAGES.all(shape), planCull(shape.sortDevice.isNarrow)];
  }

  fit({ shape }: FramePlan): PartChange | null {
    if (this.#shape && hasSameBuffers(this.#shape, shape)) return null;
    const pages = pagesOf(shape);
    const table = bufferTable(shape, pages);
    // The largest of them.
    this.#memory.check('frame visibilityMasks', ...table.visibilityMasks);
    return {
      free: () => this.#memory.destroyAll(),
      make: () => {
        const buffers = createBuffers(this.#memory, 'frame', table);
        Object.assign(this.#context.shared.buffers, buffers);
        writeConstants(this.#context.device.queue, buffers, shape, pages);
        this.#shape = shape;
      },
    };
  }

  bind(shape: FrameShape): void {
    const { pipelines, shared } = this.#context;
    const pages = pagesOf(shape);
    /** Size of a dispatch over the visible chunks of a page. */
    const overVisible = (most: number, pageIndex: number) => {
      const indirect = { buffer: shared.buffers.cullDispatches, offset: 12 * pageIndex };
      return sizeAtMost(most, shape.dispatchRow, indirect, shape.sortDevice.isNarrow);
    };
    this.dispatches = [
      ...pages.map((page, index) => {
        const stage = STAGES.of(shape, page).cullChunks!;
        return dispatchOf(pipelines, stage, shared.pages[index], sizeOverChunks(page.chunkCount, shape));
      }),
      dispatchOf(pipelines, planCull(shape.sortDevice.isNarrow), shared.buffers, ONE_WORKGROUP),
      ...pages.flatMap((page, index) => {
        const own = shared.pages[index];
        const { cutSplats: cut, cullSplats: cull } = STAGES.of(shape, page);
        const cutSize = overVisible(cutWorkgroups(page.chunkCount), index);
        return [
          ...(cut ? [dispatchOf(pipelines, cut, own, cutSize)] : []),
          dispatchOf(pipelines, cull!, own, overVisible(page.chunkCount, index)),
        ];
      }),
    ];
  }
}

/** Writes contents that last as long as the buffers: planes of all precisions share pages. */
function writeConstants(
  queue: GPUQueue,
  buffers: Pick<SharedBuffers, 'cullParameters' | 'pagePlans'>,
  { visibleCapacity, dispatchRow }: FrameShape,
  pages: readonly FramePage[],
): void {
  const counts = { chunkCount: totalChunks(pages), pageCount: pages.length, visibleCapacity };
  const parameters = CullParameters.pack({ ...counts, dispatchRow });
  queue.writeBuffer(buffers.cullParameters, 0, parameters);
  const plans = new ArrayBuffer(PagePlan.bytes * pages.length);
  for (const [index, page] of pages.entries()) {
    const found = { slotStart: 0, slotCount: 0, visibleStart: 0, visibleCount: 0 };
    const chunks = { chunkStart: page.chunkStart, chunkEnd: page.chunkStart + page.chunkCount };
    PagePlan.write(plans, { ...chunks, ...found }, index * PagePlan.bytes);
  }
  if (plans.byteLength > 0) queue.writeBuffer(buffers.pagePlans, 0, plans);
}
