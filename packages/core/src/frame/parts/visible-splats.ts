import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { CullParameters, PagePlan, SortPlan, SPLAT_RECORDS } from '../../data/layout/structs.ts';
import type { GpuMemory } from '../../gpu/gpu-memory.ts';
import { RadixSort } from '../../stages/sort/radix-sort.ts';
import { type FramePage, pagesOf, totalChunks } from '../frame-pages.ts';
import type { FramePlan } from '../plan/frame-plan.ts';
import { depthSortShape, type FrameShape, hasSameBuffers } from '../plan/frame-shape.ts';
import { createBuffers, type FramePart, type PartChange, type PartContext } from './frame-part.ts';

/** Sizes and usages of the part's buffers. */
function bufferTable({ visibleCapacity, accuracy }: FrameShape, pages: readonly FramePage[]) {
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
    projectDispatches: [12 * (pageCount + 1), STORAGE | INDIRECT],
    drawArguments: [16, STORAGE | INDIRECT],
    records: [SPLAT_RECORDS[accuracy.recordPrecision].bytes * Math.max(1, visibleCapacity), STORAGE],
  } as const;
}

/** Lists of the visible chunks and splats, in storage order, and the splats' records. */
export class VisibleSplats implements FramePart {
  readonly #context: PartContext;
  readonly #memory: GpuMemory;
  /** The shape that the buffers were made for. */
  #shape: FrameShape | null = null;

  constructor(context: PartContext) {
    this.#context = context;
    this.#memory = context.memory.part();
  }

  fit({ shape }: FramePlan): PartChange | null {
    if (this.#shape && hasSameBuffers(this.#shape, shape)) return null;
    const pages = pagesOf(shape);
    const table = bufferTable(shape, pages);
    // The largest of them. Pairs may take more, but their number is limited.
    this.#memory.check('frame visibilityMasks', ...table.visibilityMasks);
    this.#memory.check('frame records', ...table.records);
    return {
      free: () => this.#memory.destroyAll(),
      make: () => {
        const { device, shared } = this.#context;
        Object.assign(shared.resources, createBuffers(this.#memory, 'frame', table));
        this.#writeConstants(device.queue, shape, pages);
        this.#shape = shape;
      },
    };
  }

  /** Writes contents that last as long as the buffers: planes of all precisions share pages. */
  #writeConstants(
    queue: GPUQueue,
    { visibleCapacity, dispatchRow }: FrameShape,
    pages: readonly FramePage[],
  ): void {
    const { cullParameters, pagePlans } = this.#context.shared.resources;
    const counts = { chunkCount: totalChunks(pages), pageCount: pages.length, visibleCapacity };
    queue.writeBuffer(cullParameters, 0, CullParameters.pack({ ...counts, dispatchRow }));
    const plans = new ArrayBuffer(PagePlan.bytes * pages.length);
    for (const [index, page] of pages.entries()) {
      const found = { slotStart: 0, slotCount: 0, visibleStart: 0, visibleCount: 0 };
      const chunks = { chunkStart: page.chunkStart, chunkEnd: page.chunkStart + page.chunkCount };
      PagePlan.write(plans, { ...chunks, ...found }, index * PagePlan.bytes);
    }
    if (plans.byteLength > 0) queue.writeBuffer(pagePlans, 0, plans);
  }
}

/** The sort of frames of one key width and capacity. */
interface HeldSort {
  readonly sort: RadixSort;
  readonly keyBits: number;
  readonly capacity: number;
}

/**
 * Sorts the visible splats, far first; holds their keys, their number and their order. A part of its own: keys of
 * other widths leave the records as they are.
 */
export class Sort implements FramePart {
  readonly #context: PartContext;
  /** Memory of `#held`. */
  readonly #memory: GpuMemory;
  #held: HeldSort | null = null;

  constructor(context: PartContext) {
    this.#context = context;
    this.#memory = context.memory.part();
  }

  get sort(): RadixSort {
    return this.#held!.sort;
  }

  fit({ shape }: FramePlan): PartChange | null {
    const { keyBits, visibleCapacity } = shape;
    const held = this.#held;
    if (held?.keyBits === keyBits && held.capacity === visibleCapacity) return null;
    // No buffer exceeds the records buffer, whose size pre-process checks.
    return {
      free: () => this.#memory.destroyAll(),
      make: () => {
        this.#held = { sort: this.#make(shape), keyBits, capacity: visibleCapacity };
      },
    };
  }

  #make(shape: FrameShape): RadixSort {
    const { visibleCapacity, dispatchRow } = shape;
    const { device, pipelines, shared } = this.#context;
    const memory = this.#memory;
    const { STORAGE, INDIRECT } = GPUBufferUsage;
    // plan-project writes them.
    const buffers = createBuffers(memory, 'frame', {
      visibleCount: [4, STORAGE],
      depthSortPlan: [SortPlan.bytes, STORAGE],
      depthSortDispatch: [12, STORAGE | INDIRECT],
    });
    const sort = new RadixSort(device, pipelines, memory, {
      shape: depthSortShape(shape),
      capacity: visibleCapacity,
      plan: buffers.depthSortPlan,
      blockDispatch: { buffer: buffers.depthSortDispatch, offset: 0 },
      dispatchRow,
    });
    const { keys, upperKeys, order } = sort;
    Object.assign(shared.resources, { ...buffers, keys, upperKeys, order });
    return sort;
  }
}
