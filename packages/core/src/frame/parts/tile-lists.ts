import { binGrid } from '../../data/layout/bin-grid.ts';
import { SHADER_CONSTANTS } from '../../data/layout/constants.ts';
import { roundUp } from '../../data/layout/gpu-struct.ts';
import { SortPlan, TileGrid, TilePlan } from '../../data/layout/structs.ts';
import type { GpuMemory } from '../../gpu/gpu-memory.ts';
import { type Dispatch, type DispatchSize, dispatchOf, ONE_WORKGROUP } from '../../gpu/passes.ts';
import type { CompiledStage } from '../../gpu/pipelines.ts';
import { dispatchSize, sizeAtMost } from '../../stages/dispatch.ts';
import { RadixSort, radixSortStages } from '../../stages/sort/radix-sort.ts';
import { blockKeysOf } from '../../stages/sort/sort.ts';
import { tileCount, tileEmit, tileMasks, tilePlan, tileRanges } from '../../stages/tiles/tiles.ts';
import { pagesOf } from '../frame-pages.ts';
import { createBuffers, type FramePart, type PartChange, type PartContext } from '../frame-part.ts';
import type { FramePlan } from '../frame-plan.ts';
import { type FrameShape, perShape } from '../frame-shape.ts';
import { PAIR_BYTES, PairRoom } from '../pair-capacity.ts';
import { pairSortShape } from '../sort-shapes.ts';

const { BIN_TILES, MASK_GROUP, TILE_COUNT_BLOCK } = SHADER_CONSTANTS;
const MASK_WORDS = (BIN_TILES * BIN_TILES * MASK_GROUP) / 32;

const stages = perShape((shape) => {
  const { recordPrecision, extent } = shape.accuracy;
  const { isNarrow } = shape.sortDevice;
  const variant = { recordPrecision, extent, isStacked: shape.isStacked, isNarrow };
  const sortShape = pairSortShape(shape);
  return {
    tileCount: tileCount(variant),
    tilePlan: tilePlan(sortShape),
    tileRecount: tileCount(variant, true),
    tileReplan: tilePlan(sortShape, true),
    tileEmit: tileEmit(variant, sortShape),
    tileRanges,
    tileMasks: tileMasks(variant),
  };
});

/** Frames that quads draw in a row only to be compared before the room for tiles is given back. */
const MAX_FRAMES_UNUSED = 120;

/** tile-plan and tile-emit do part of the sort's work. */
const SORT_OPTIONS = { firstCounts: 'given' } as const;

/** Names and sizes of the part's own buffers. */
function bufferTable(visibleCapacity: number, pairs: number, binCount: number) {
  const { INDIRECT, STORAGE, UNIFORM } = GPUBufferUsage;
  return {
    grid: [TileGrid.bytes, UNIFORM],
    tilePlan: [TilePlan.bytes, STORAGE],
    sortPlan: [SortPlan.bytes, STORAGE],
    pairDispatches: [24, STORAGE | INDIRECT],
    blockPairs: [4 * Math.max(1, Math.ceil(visibleCapacity / TILE_COUNT_BLOCK)), STORAGE],
    binStarts: [4 * (binCount + 1), STORAGE],
    binOrder: [4 * binCount, STORAGE],
    tileMasks: [4 * MASK_WORDS * Math.ceil(pairs / MASK_GROUP), STORAGE],
  } as const;
}

type BufferName = keyof ReturnType<typeof bufferTable>;

interface Held {
  readonly buffers: Readonly<Record<BufferName, GPUBuffer>>;
  readonly sort: RadixSort;
  readonly visibleCapacity: number;
  readonly pairCapacity: number;
  readonly binCount: number;
}

type StageName = keyof ReturnType<typeof stages>;

/**
 * Lists, for each bin of the layer, the visible splats that it may show, front to back, with the
 * tiles that each may touch. Bins are larger where there is no room for all pairs.
 * `drawArguments` leaves a frame to the quads if there is no room for its visible splats either.
 */
export class TileLists implements FramePart {
  /** Lists the pairs; empty for shapes without tiles. */
  dispatches: readonly Dispatch[] = [];
  readonly #context: PartContext;
  /** Memory of `#held`. */
  readonly #memory: GpuMemory;
  #held: Held | null = null;
  #room = new PairRoom();
  /** Frames in a row that quads drew. */
  #framesUnused = 0;

  constructor(context: PartContext) {
    this.#context = context;
    this.#memory = context.memory.part();
  }

  static stages(shape: FrameShape): readonly CompiledStage[] {
    if (shape.rasterizer !== 'tiles') return [];
    return [...Object.values(stages(shape)), ...radixSortStages(pairSortShape(shape), SORT_OPTIONS)];
  }

  /** Bytes of the part's buffers. */
  get bytes(): number {
    return this.#memory.report().totalBytes;
  }

  /** Why lists of `pairs` pairs never fit, even with one bin, a pair per visible splat; null if they do. */
  whyTooMany(pairs: number): string | null {
    if (pairs <= this.#mostPairs()) return null;
    const megabytes = (bytes: number) => `${Math.ceil(bytes / 1e6)} MB`;
    const [needed, allowed] = [pairs, this.#mostPairs()].map((count) => megabytes(count * PAIR_BYTES));
    return `tiles would need ${needed} for their lists, and ${allowed} are allowed`;
  }

  /**
   * Takes the pairs of a frame whose statistics arrived at `atMs`: the next one has room, if that
   * may be, or else for a pair of each visible splat.
   */
  expect(neededPairs: number, visibleSplats: number, atMs: number): void {
    this.#room.take(neededPairs <= this.#mostPairs() ? neededPairs : visibleSplats, atMs);
  }

  fit({ shape }: FramePlan): PartChange | null {
    const { visibleCapacity, binCount } = shape;
    const held = this.#held;
    if (shape.rasterizer !== 'tiles') {
      if (!held || this.#isCompared(shape, held)) return null;
      return { free: () => this.#leave(), make: () => {} };
    }
    this.#framesUnused = 0;
    const current = held?.pairCapacity ?? 0;
    const isSame = held?.visibleCapacity === visibleCapacity && held.binCount === binCount;
    const pairs = this.#room.next(current, visibleCapacity, this.#mostPairs(), isSame);
    if (isSame && pairs === current) return null;
    // No buffer exceeds the records, or the buffers of pairs, whose number is limited.
    return {
      free: () => this.#memory.destroyAll(),
      make: () => {
        const made = this.#make(shape, pairs);
        this.#held = made;
        this.#room.made(visibleCapacity);
        const { grid, tilePlan, binStarts, binOrder, tileMasks } = made.buffers;
        const shared = { tileGrid: grid, tilePlan, binStarts, binOrder, tileMasks };
        Object.assign(this.#context.shared.buffers, { ...shared, sortedRecords: made.sort.order });
      },
    };
  }

  bind(shape: FrameShape): void {
    this.dispatches = [];
    if (!this.#held || shape.rasterizer !== 'tiles') return;
    const { pipelines, shared } = this.#context;
    const { sort, buffers, visibleCapacity, pairCapacity } = this.#held;
    const all = {
      ...shared.buffers,
      ...buffers,
      // The keys are of no use once they are sorted.
      pairOffsets: shared.buffers.keys,
      pairBins: sort.input.keys,
      pairRecords: sort.input.payloads,
      digitCounts: sort.digitCounts,
      sortedBins: sort.sortedKeys!,
      sortedRecords: sort.order,
    };
    const run = (name: StageName, size: DispatchSize = ONE_WORKGROUP) =>
      dispatchOf(pipelines, stages(shape)[name], all, size);
    // Wide devices start all that there is room for: workgroups without pairs cost them little.
    const sizeOf = (mostWorkgroups: number, buffer: GPUBuffer, offset: number) => {
      const most = Math.ceil(mostWorkgroups);
      return shape.sortDevice.isNarrow
        ? sizeAtMost(most, shape.dispatchRow, { buffer, offset }, true)
        : dispatchSize(Math.max(1, most), shape.dispatchRow);
    };
    const { projectDispatches } = shared.buffers;
    const counted = sizeOf(visibleCapacity / TILE_COUNT_BLOCK, projectDispatches, 12 * pagesOf(shape).length);
    this.dispatches = [
      run('tileCount', counted),
      run('tilePlan'),
      run('tileRecount', counted),
      run('tileReplan'),
      run('tileEmit', sizeOf(pairCapacity / blockKeysOf(sort.shape), buffers.pairDispatches, 0)),
      ...sort.dispatches,
      run('tileRanges'),
      run('tileMasks', sizeOf(pairCapacity / MASK_GROUP, buffers.pairDispatches, 12)),
    ];
  }

  write({ layer, shape }: FramePlan): void {
    if (!this.#held || shape.rasterizer !== 'tiles') return;
    const contents = TileGrid.pack({
      sizePx: [layer.widthPx, layer.heightPx],
      ...binGrid(layer.widthPx, layer.heightPx),
      pairCapacity: this.#held.pairCapacity,
      firstTile: 0,
    });
    this.#context.device.queue.writeBuffer(this.#held.buffers.grid, 0, contents);
  }

  /** Frees the lists, because quads draw. */
  #leave(): void {
    this.#memory.destroyAll();
    this.#held = null;
    this.dispatches = [];
    this.#room = new PairRoom();
    this.#framesUnused = 0;
  }

  /** Whether quads draw a frame only to be compared, so that tiles may soon draw again. */
  #isCompared({ accuracy, visibleCapacity }: FrameShape, held: Held): boolean {
    this.#framesUnused++;
    return (
      accuracy.rasterizer === 'auto' &&
      held.visibleCapacity === visibleCapacity &&
      this.#framesUnused <= MAX_FRAMES_UNUSED
    );
  }

  #mostPairs(): number {
    const { tileBudgetBytes } = this.#context;
    const { maxBufferSize, maxStorageBufferBindingSize } = this.#context.device.limits;
    const maskBytes = (4 * MASK_WORDS) / MASK_GROUP;
    const bindable = Math.min(maxBufferSize, maxStorageBufferBindingSize) / maskBytes;
    return Math.floor(Math.min(bindable, tileBudgetBytes / PAIR_BYTES) / MASK_GROUP) * MASK_GROUP;
  }

  #make(shape: FrameShape, pairs: number): Held {
    const { device, pipelines } = this.#context;
    const memory = this.#memory;
    const { visibleCapacity, binCount, dispatchRow } = shape;
    // The sort's halves of the masks begin at multiples of 256 bytes.
    const room = roundUp(pairs, MASK_GROUP);
    const buffers = createBuffers(memory, 'tiles', bufferTable(visibleCapacity, room, binCount));
    const sort = new RadixSort(device, pipelines, memory, {
      shape: pairSortShape(shape),
      capacity: room,
      dispatchRow,
      payloads: 'given',
      writesKeys: true,
      firstCounts: SORT_OPTIONS.firstCounts,
      plan: buffers.sortPlan,
      ...(shape.sortDevice.isNarrow && { blockDispatch: { buffer: buffers.pairDispatches, offset: 0 } }),
      // The masks are written after the sort.
      spare: buffers.tileMasks,
      label: 'tiles sort',
    });
    return { buffers, sort, visibleCapacity, pairCapacity: pairs, binCount };
  }
}
