import { SortPlan } from '../../data/layout/structs.ts';
import type { GpuMemory } from '../../gpu/gpu-memory.ts';
import { RadixSort } from '../../stages/sort/radix-sort.ts';
import { createBuffers, type FramePart, type PartChange, type PartContext } from '../frame-part.ts';
import type { FramePlan } from '../frame-plan.ts';
import { depthSortShape, type FrameShape } from '../frame-shape.ts';

/** The part's memory for frames of one key width, ranking and capacity. */
interface Held {
  readonly sort: RadixSort;
  readonly keyBits: number;
  readonly capacity: number;
}

/** Sorts the visible splats, far first; holds their keys, their number and their order. */
export class Sort implements FramePart {
  readonly #context: PartContext;
  /** Memory of `#held`. */
  readonly #memory: GpuMemory;
  #held: Held | null = null;

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
