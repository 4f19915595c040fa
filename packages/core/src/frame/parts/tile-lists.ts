import { binGrid } from '../../data/layout/bin-grid.ts';
import { SHADER_CONSTANTS } from '../../data/layout/constants.ts';
import { roundUp } from '../../data/layout/gpu-struct.ts';
import { SortPlan, TileGrid, TilePlan } from '../../data/layout/structs.ts';
import type { GpuMemory } from '../../gpu/gpu-memory.ts';
import { RadixSort } from '../../stages/sort/radix-sort.ts';
import { splitsTiles, tilesOf } from '../frame-passes.ts';
import type { FramePlan } from '../plan/frame-plan.ts';
import { type FrameShape, PAIR_SORT_OPTIONS, pairSortShape } from '../plan/frame-shape.ts';
import { createBuffers, type FramePart, type PartChange, type PartContext } from './frame-part.ts';
import { PAIR_BYTES, PairRoom } from './pair-capacity.ts';

const { BIN_TILES, MASK_GROUP, TILE_COUNT_BLOCK, TILE_PX } = SHADER_CONSTANTS;
const MASK_WORDS = (BIN_TILES * BIN_TILES * MASK_GROUP) / 32;

/** Frames that quads draw in a row only to be compared before the room for tiles is given back. */
const MAX_FRAMES_UNUSED = 120;

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

/**
 * Lists, for each bin of the layer, the visible splats that it may show, front to back, with the
 * tiles that each may touch. Bins are larger where there is no room for all pairs.
 * `drawArguments` leaves a frame to the quads if there is no room for its visible splats either.
 */
export class TileLists implements FramePart {
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

  /** Sort of the pairs; null without room for tiles. */
  get sort(): RadixSort | null {
    return this.#held?.sort ?? null;
  }

  get pairCapacity(): number {
    return this.#held?.pairCapacity ?? 0;
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
        const { buffers, sort } = made;
        Object.assign(this.#context.shared.resources, buffers, {
          pairBins: sort.input.keys,
          pairRecords: sort.input.payloads,
          pairDigitCounts: sort.digitCounts,
          sortedBins: sort.sortedKeys,
          sortedRecords: sort.order,
        });
      },
    };
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
      firstCounts: PAIR_SORT_OPTIONS.firstCounts,
      plan: buffers.sortPlan,
      ...(shape.sortDevice.isNarrow && { blockDispatch: { buffer: buffers.pairDispatches, offset: 0 } }),
      // The masks are written after the sort.
      spare: buffers.tileMasks,
      label: 'tiles sort',
    });
    return { buffers, sort, visibleCapacity, pairCapacity: pairs, binCount };
  }
}

/** Most tiles with long lists whose front is kept, a kilobyte each; others are blended from the front again. */
const MOST_FRONTS = 4096;
const FRONT_BYTES = 16 * TILE_PX ** 2;

/** The tiles whose ends of lists are left to tile-rest, with their fronts: see tile-rasterize. */
export class LongTiles implements FramePart {
  readonly #context: PartContext;
  readonly #memory: GpuMemory;
  #tileCount = 0;

  constructor(context: PartContext) {
    this.#context = context;
    this.#memory = context.memory.part();
  }

  fit({ shape }: FramePlan): PartChange | null {
    const tileCount = splitsTiles(shape) ? tilesOf(shape) : 0;
    if (tileCount === this.#tileCount) return null;
    return {
      free: () => this.#memory.destroyAll(),
      make: () => {
        this.#tileCount = tileCount;
        if (tileCount === 0) return;
        const buffers = createBuffers(this.#memory, 'tiles', {
          longTiles: [8 + 8 * tileCount, GPUBufferUsage.STORAGE],
          frontPixels: [FRONT_BYTES * Math.min(MOST_FRONTS, tileCount), GPUBufferUsage.STORAGE],
        });
        Object.assign(this.#context.shared.resources, buffers);
      },
    };
  }
}
