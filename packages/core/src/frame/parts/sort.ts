import type { CompiledStage } from '../../gpu/pipelines.ts';
import { RadixSort, radixSortStages } from '../../stages/radix-sort.ts';
import type { FramePart, OrderRecording, PartChange, PartContext } from '../frame-part.ts';
import type { FramePlan } from '../frame-plan.ts';
import { type FrameShape, perShape } from '../frame-shape.ts';
import { depthSortShape } from '../sort-shapes.ts';

const stagesOf = perShape((shape) => radixSortStages(depthSortShape(shape)));

/** The part's memory for frames of one key width and capacity. */
interface Held {
  readonly sort: RadixSort;
  readonly visibleCount: GPUBuffer;
  readonly keyBits: number;
  readonly capacity: number;
}

/** Sorts the visible splats, far first; holds their keys, their number and their order. */
export class Sort implements FramePart<OrderRecording> {
  readonly #context: PartContext;
  #held: Held | null = null;

  constructor(context: PartContext) {
    this.#context = context;
  }

  static stages(shape: FrameShape): readonly CompiledStage[] {
    return stagesOf(shape);
  }

  get sort(): RadixSort {
    return this.#held!.sort;
  }

  fit({ shape }: FramePlan): PartChange | null {
    const { keyBits, visibleCapacity } = shape;
    if (this.#held?.keyBits === keyBits && this.#held.capacity === visibleCapacity) return null;
    const held = this.#make(shape);
    return {
      commit: () => {
        this.#free(this.#held);
        this.#held = held;
        const { sort, visibleCount } = held;
        Object.assign(this.#context.shared.buffers, { visibleCount, keys: sort.keys, order: sort.order });
      },
      discard: () => this.#free(held),
    };
  }

  record({ encoder, timer, isColorsOnly }: OrderRecording): void {
    if (isColorsOnly) return;
    const pass = encoder.beginComputePass({ label: 'sort', timestampWrites: timer.writes('sort') });
    this.sort.record(pass);
    pass.end();
  }

  destroy(): void {
    this.#free(this.#held);
  }

  #make(frame: FrameShape): Held {
    const { keyBits, visibleCapacity, dispatchRow } = frame;
    const { device, pipelines, memory } = this.#context;
    const usage = GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_DST | GPUBufferUsage.COPY_SRC;
    const visibleCount = memory.createBuffer('frame visibleCount', 4, usage);
    try {
      const options = {
        shape: depthSortShape(frame),
        capacity: visibleCapacity,
        keyCount: visibleCount,
        dispatchRow,
      };
      const sort = new RadixSort(device, pipelines, memory, options);
      return { sort, visibleCount, keyBits, capacity: visibleCapacity };
    } catch (error) {
      memory.destroy(visibleCount);
      throw error;
    }
  }

  #free(held: Held | null): void {
    if (!held) return;
    held.sort.destroy();
    this.#context.memory.destroy(held.visibleCount);
  }
}
