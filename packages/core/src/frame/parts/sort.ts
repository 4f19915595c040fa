import type { GpuMemory } from '../../gpu/gpu-memory.ts';
import type { CompiledStage } from '../../gpu/pipelines.ts';
import { RadixSort, radixSortStages } from '../../stages/radix-sort.ts';
import type { FramePart, OrderRecording, PartChange, PartContext } from '../frame-part.ts';
import type { FramePlan, LentOrder } from '../frame-plan.ts';
import { type FrameShape, perShape } from '../frame-shape.ts';
import { depthSortShape } from '../sort-shapes.ts';

const stagesOf = perShape((shape) => radixSortStages(depthSortShape(shape)));

/** The part's memory for frames of one key width, ranking and capacity. */
interface Held {
  /** Null where the order of another view is taken. */
  readonly sort: RadixSort | null;
  readonly taken: LentOrder['buffers'] | undefined;
  readonly keyBits: number;
  readonly ballots: FrameShape['ballots'];
  readonly capacity: number;
}

/** Sorts the visible splats, far first; holds their keys, their number and their order. */
export class Sort implements FramePart<OrderRecording> {
  readonly #context: PartContext;
  /** Memory of `#held`. */
  readonly #memory: GpuMemory;
  #held: Held | null = null;

  constructor(context: PartContext) {
    this.#context = context;
    this.#memory = context.memory.part();
  }

  static stages(shape: FrameShape): readonly CompiledStage[] {
    return stagesOf(shape);
  }

  get sort(): RadixSort {
    return this.#held!.sort!;
  }

  fit(plan: FramePlan): PartChange | null {
    const { shape } = plan;
    const taken = plan.taken?.buffers;
    const { keyBits, visibleCapacity, ballots } = shape;
    const held = this.#held;
    const isSame =
      held?.keyBits === keyBits &&
      held.ballots === ballots &&
      held.capacity === visibleCapacity &&
      held.taken === taken;
    if (isSame) return null;
    // No buffer is larger than that of the records, which pre-process checks.
    return {
      free: () => this.#memory.destroyAll(),
      make: () => {
        const sort = this.#make(shape, taken);
        this.#held = { sort, taken, keyBits, ballots, capacity: visibleCapacity };
      },
    };
  }

  record({ encoder, timer, isColorsOnly }: OrderRecording): void {
    const sort = this.#held?.sort;
    if (!sort || isColorsOnly) return;
    const pass = encoder.beginComputePass({ label: 'sort', timestampWrites: timer.writes('sort') });
    sort.record(pass);
    pass.end();
  }

  #make(shape: FrameShape, taken: LentOrder['buffers'] | undefined): RadixSort | null {
    const { visibleCapacity, dispatchRow } = shape;
    const { device, pipelines, shared } = this.#context;
    const memory = this.#memory;
    const make = (name: string, bytes: number) => {
      const usage = GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_DST | GPUBufferUsage.COPY_SRC;
      return memory.createBuffer(`frame ${name}`, bytes, usage);
    };
    if (taken) {
      const { visibleCount, order } = taken;
      // They are written, though nothing sorts them, and are then of use to later stages.
      const keys = make('keys', 4 * Math.max(1, visibleCapacity));
      Object.assign(shared.buffers, { visibleCount, keys, order });
      return null;
    }
    const visibleCount = make('visibleCount', 4);
    const sort = new RadixSort(device, pipelines, memory, {
      shape: depthSortShape(shape),
      capacity: visibleCapacity,
      keyCount: visibleCount,
      dispatchRow,
    });
    Object.assign(shared.buffers, { visibleCount, keys: sort.keys, order: sort.order });
    return sort;
  }
}
