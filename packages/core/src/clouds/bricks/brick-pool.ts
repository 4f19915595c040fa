import type { Brick, BrickAddress, BrickCell, BrickScene } from '../../data/bricks/brick.ts';
import { SplatFileError } from '../../data/errors.ts';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import {
  ChunkLinks,
  LEVEL_CONSTANTS,
  LevelCell,
  MergeParameters,
  OpenedLeaves,
} from '../../data/layout/level-structs.ts';
import type { GpuMemory } from '../../gpu/gpu-memory.ts';
import type { StageDefinition } from '../../gpu/pipelines.ts';
import { openLeaves } from '../../stages/cut/cut.ts';
import { type DispatchContext, Dispatches } from '../ingest/dispatches.ts';
import type { BlobPage, Levels } from '../levels.ts';
import type { SplatCloud, SplatCloudOptions } from '../splat-cloud.ts';
import {
  BLOB_WORDS,
  ChunkPages,
  emptyLinks,
  freeBlobPage,
  LINKS_BYTES,
  makeBlobPage,
  mergeStages,
  nowhereCells,
  poolBuffer,
  upperBindings,
  writeCells,
} from '../stream/chunk-pages.ts';
import { makePool, resizedPool, streamedCloud } from '../stream/make-pool.ts';
import { BRICK_LEAVES, type PoolSlots, poolBytes } from './pool-slots.ts';

const { CELL_CHILDREN, CELL_ROOTS, NO_CELL } = LEVEL_CONSTANTS;
const HEAD_WORDS = ChunkLinks.words - CHUNK_SPLATS;

/** A cell of a brick on the GPU. */
export interface PlacedCell extends BrickCell {
  readonly brick: PlacedBrick;
  /** Index among the cells of the pool. Resizing the pool changes it, and the slot of the brick. */
  cell: number;
  /** The brick with the cells below; null while it is not on the GPU. */
  below: PlacedBrick | null;
}

/** A brick on the GPU. */
export interface PlacedBrick {
  readonly address: BrickAddress;
  readonly level: number;
  slot: number;
  readonly cells: readonly PlacedCell[];
  /** The cell above; null for the root. */
  readonly above: PlacedCell | null;
}

/**
 * GPU memory for bricks of one scene, drawn by its cloud. New bricks replace others; nothing is
 * allocated once the pool is made. A brick is placed below its parent, whose leaves are drawn while
 * the brick is missing. The caller alone decides which bricks are resident.
 */
export class BrickPool implements Levels {
  readonly slots: PoolSlots;
  readonly cellCount: number;
  readonly chunkCells: number;
  readonly cells: GPUBuffer;
  readonly blobPages: readonly BlobPage[];
  readonly refinement = null;
  readonly #context: DispatchContext;
  readonly #memory: GpuMemory;
  readonly #scene: BrickScene;
  readonly #chunks: ChunkPages;
  readonly #free: { readonly lowest: number[]; readonly upper: number[] };
  /** Indexed by slot. */
  readonly #placed: { readonly lowest: PlacedBrick[]; readonly upper: PlacedBrick[] } = {
    lowest: [],
    upper: [],
  };
  #cloud: SplatCloud | null = null;

  /**
   * @param before a smaller or larger pool whose bricks move into the first slots; they must fit.
   */
  private constructor(
    context: DispatchContext,
    memory: GpuMemory,
    scene: BrickScene,
    slots: PoolSlots,
    before: BrickPool | null = null,
  ) {
    const { name, shDegree } = scene;
    this.#context = context;
    this.#memory = memory;
    this.#scene = scene;
    this.slots = slots;
    // The last cell belongs to empty chunks: never in sight and never drawn.
    this.cellCount = CELL_CHILDREN * (slots.lowest + slots.upper) + 1;
    this.chunkCells = CELL_CHILDREN * slots.lowest;
    this.cells = poolBuffer(memory, `${name} cells`, LevelCell.bytes * this.cellCount);
    // Blobs, more than half of a pool, are freed first and merged again, so that two pools fit in
    // memory.
    if (before) before.#chunks.freeBlobs();
    const upperLeaves = 2 * BRICK_LEAVES * slots.upper;
    const upperPage = makeBlobPage(memory, `${name} upper blob`, shDegree, this.cells, upperLeaves);
    if (before) this.#copyLeaves(before, upperPage);
    const moves = Object.values(before ? before.#placed.lowest : []).map(({ slot, cells }, i) => ({
      from: CELL_CHILDREN * slot,
      to: CELL_CHILDREN * i,
      count: cells.length,
    }));
    this.#chunks = new ChunkPages(
      context,
      memory,
      scene,
      this.chunkCells,
      this.cells,
      this.#nowhere,
      before && { pages: before.#chunks, moves },
    );
    this.blobPages = [...this.#chunks.blobPages, upperPage];
    const downFrom = (count: number) => Array.from({ length: count }, (_, i) => count - 1 - i);
    this.#free = { lowest: downFrom(slots.lowest), upper: downFrom(slots.upper) };
  }

  /**
   * Makes an empty pool.
   *
   * @throws GpuLimitError if the device has no room for it; nothing is left allocated then.
   */
  static async make(context: DispatchContext, scene: BrickScene, slots: PoolSlots): Promise<BrickPool> {
    return makePool(context, scene, rootStages(scene), (memory) => {
      const made = new BrickPool({ ...context, memory }, memory, scene, slots);
      made.#clear();
      return made;
    });
  }

  /**
   * Resolves when the shaders for placing bricks of a level are compiled. The root's are compiled
   * before the pool exists.
   */
  ready(level: number): Promise<void> {
    return this.#context.pipelines.prepare(stagesOf(this.#scene, kindOf(level)));
  }

  /**
   * Makes a pool of another size with all bricks of this one, which replaces this one in its cloud.
   * Both together never take more memory than the larger one. Splats and leaves are copied on the
   * GPU; their blobs are merged again. Returns this pool if the engine's memory budget has no room
   * for the other.
   */
  resized(slots: PoolSlots): BrickPool {
    const [bytes, held] = [slots, this.slots].map((each) => poolBytes(this.#scene.shDegree, each));
    return (
      resizedPool(this.#memory, this.#cloud!, bytes - held, () => {
        const pool = new BrickPool(this.#context, this.#memory, this.#scene, slots, this);
        pool.#clear();
        pool.#takeOver(this);
        pool.#cloud = this.#cloud;
        return { pool, pages: pool.#chunks };
      }) ?? this
    );
  }

  get splatLinks(): readonly GPUBuffer[] {
    return this.#chunks.splatLinks;
  }

  /** Makes the cloud that draws this pool. */
  cloud(options: Pick<SplatCloudOptions, 'onDestroyed'> = {}): SplatCloud {
    const cloud = streamedCloud(this.#context.device, this.#scene, this.#chunks, this, options);
    this.#cloud = cloud;
    return cloud;
  }

  /** Bytes of the pool without the planes of splats, which the cloud counts. */
  get bytes(): number {
    return this.#memory.report().totalBytes - this.#chunks.planes.bytes;
  }

  /** Most splats and blobs that one frame can draw from this pool. */
  get capacity(): number {
    return BRICK_LEAVES * (this.slots.lowest + this.slots.upper);
  }

  get chunks(): ArrayBuffer {
    return this.#chunks.words.buffer;
  }

  /** Free slots for bricks of a level. */
  freeSlots(level: number): number {
    return this.#free[kindOf(level)].length;
  }

  /** Bricks on the GPU. */
  get bricks(): readonly PlacedBrick[] {
    return [...this.#placed.upper, ...this.#placed.lowest].filter(Boolean);
  }

  /**
   * Writes a brick into a free slot, merges its blobs, and has it drawn wherever its parent is too
   * coarse. `ready` must have resolved.
   *
   * @param above the cell whose `child` the brick is; null for the root.
   * @param instead a brick of the same kind to remove first if no slot is free; else null.
   * @throws SplatFileError if the brick does not fit its place; nothing is changed then.
   */
  place(
    brick: Brick,
    address: BrickAddress,
    above: PlacedCell | null,
    instead: PlacedBrick | null = null,
  ): PlacedBrick {
    this.#check(brick, address, above);
    if (instead) this.remove(instead);
    const kind = kindOf(brick.level);
    const slot = this.#free[kind].pop()!;
    const start = this.#firstCell(kind, slot);
    const placed: PlacedBrick & { cells: PlacedCell[] } = {
      address,
      level: brick.level,
      slot,
      cells: [],
      above,
    };
    placed.cells = brick.cells.map((cell, i) => ({ ...cell, brick: placed, cell: start + i, below: null }));
    this.#placed[kind][slot] = placed;
    writeCells(this.#context.device, this.cells, placed.cells, start, above?.cell ?? NO_CELL);
    if (kind === 'lowest') this.#chunks.write(brick, start, above?.childErrors);
    else this.#writeLeaves(brick, placed);
    const dispatches = new Dispatches(this.#context);
    this.#activate(dispatches, placed);
    if (above) {
      above.below = placed;
      this.#open(dispatches, above);
    }
    dispatches.submit(`${this.#scene.name} brick`);
    this.#changed();
    return placed;
  }

  /** Removes a brick and all of its descendants; its parent's leaves are drawn instead. */
  remove(brick: PlacedBrick): void {
    for (const { below } of brick.cells) if (below) this.remove(below);
    const { above, slot, level } = brick;
    const kind = kindOf(level);
    if (above) {
      above.below = null;
      const closing = new Dispatches(this.#context);
      this.#open(closing, above);
      closing.submit(`${this.#scene.name} brick`);
    }
    this.#clearLinks(kind, slot);
    if (kind === 'lowest') this.#chunks.unbound(CELL_CHILDREN * slot, CELL_CHILDREN * (slot + 1));
    delete this.#placed[kind][slot];
    this.#free[kind].push(slot);
    this.#changed();
  }

  levelOf(cell: number): number {
    return this.#placed.upper[Math.floor((cell - this.chunkCells) / CELL_CHILDREN)]?.level ?? 0;
  }

  childCell(cell: number, slot: number): number | null {
    const index = cell - this.chunkCells;
    const brick = this.#placed.upper[Math.floor(index / CELL_CHILDREN)];
    const below = brick?.cells[index % CELL_CHILDREN]?.below;
    return below?.cells[Math.floor(slot / CELL_ROOTS)]?.cell ?? null;
  }

  /** Resolves when the GPU has finished all submitted work. */
  whenDone(): Promise<unknown> {
    return this.#context.device.queue.onSubmittedWorkDone();
  }

  destroy(): void {
    this.#memory.destroyAll();
  }

  get #nowhere(): number {
    return this.cellCount - 1;
  }

  #firstCell(kind: Kind, slot: number): number {
    return CELL_CHILDREN * slot + (kind === 'lowest' ? 0 : this.chunkCells);
  }

  #check({ level, cells }: Brick, { number }: BrickAddress, above: PlacedCell | null): void {
    const wrong = (found: string) => {
      throw new SplatFileError(
        'damaged',
        this.#scene.name,
        `Brick ${number} ${found}. Convert the scene again.`,
      );
    };
    if (above && level !== above.brick.level - 1)
      wrong(`is of level ${level}, and lies below one of level ${above.brick.level}`);
    const expected = above ? above.childErrors.length : 1;
    if (cells.length !== expected) wrong(`has ${cells.length} cells, and ${expected} are to be there`);
    const isFull = ({ leafCount }: BrickCell, i: number) =>
      i + 1 === cells.length ? leafCount > 0 && leafCount <= CHUNK_SPLATS : leafCount === CHUNK_SPLATS;
    if (level === 0 && !cells.every(isFull)) wrong('has cells with gaps');
  }

  /** Adds dispatches that merge the blobs of a placed brick and open its cells for drawing. */
  #activate(dispatches: Dispatches, placed: PlacedBrick): void {
    this.#merge(dispatches, placed);
    for (const cell of placed.cells) if (placed.level > 0) this.#open(dispatches, cell);
  }

  /**
   * Takes over the bricks of another pool. Their splats and leaves must have been copied, in the
   * same order.
   */
  #takeOver(before: BrickPool): void {
    // `Object.values` skips free slots.
    for (const kind of ['lowest', 'upper'] as const)
      for (const brick of Object.values(before.#placed[kind])) {
        const slot = this.#free[kind].pop()!;
        const start = this.#firstCell(kind, slot);
        if (kind === 'lowest') {
          const first = CHUNK_SPLATS * CELL_CHILDREN * brick.slot;
          const rows = before.#chunks.rows.subarray(first, first + CHUNK_SPLATS * brick.cells.length);
          this.#chunks.keep({ cells: brick.cells, rows }, start, brick.above?.childErrors);
        }
        brick.slot = slot;
        for (const [i, cell] of brick.cells.entries()) cell.cell = start + i;
        this.#placed[kind][slot] = brick;
      }
    for (const brick of this.bricks) {
      const { cells, above, level } = brick;
      writeCells(this.#context.device, this.cells, cells, cells[0].cell, above?.cell ?? NO_CELL);
      if (level > 0) this.#writeErrors(brick);
      const dispatches = new Dispatches(this.#context);
      this.#activate(dispatches, brick);
      dispatches.submit(`${this.#scene.name} brick`);
    }
  }

  /** Copies the leaves of another pool's upper bricks, then frees their page and cells. */
  #copyLeaves(before: BrickPool, page: BlobPage): void {
    const encoder = this.#context.device.createCommandEncoder({ label: 'pool' });
    const from = before.blobPages.at(-1)!;
    const copy = (read: GPUBuffer | null, written: GPUBuffer | null) => {
      if (!read || !written) return;
      const bytes = read.size / before.slots.upper;
      for (const [i, { slot }] of Object.values(before.#placed.upper).entries())
        encoder.copyBufferToBuffer(read, bytes * slot, written, bytes * i, bytes);
    };
    copy(from.geometry, page.geometry);
    copy(from.shRest, page.shRest);
    this.#context.device.queue.submit([encoder.finish()]);
    freeBlobPage(this.#memory, from);
    this.#memory.destroy(before.cells);
  }

  /** Writes the leaves of an upper brick with the errors of their cells, as input for merging. */
  #writeLeaves({ cells, geometry, harmonics }: Brick, placed: PlacedBrick): void {
    const { queue } = this.#context.device;
    const { geometry: blobs, shRest } = this.blobPages.at(-1)!;
    const shWords = harmonics.length / (geometry.length / BLOB_WORDS);
    for (const i of cells.keys()) {
      const chunk = 2 * (CELL_CHILDREN * placed.slot + i);
      const part = (words: Uint32Array<ArrayBuffer>, perLeaf: number) =>
        words.subarray(CHUNK_SPLATS * perLeaf * i, CHUNK_SPLATS * perLeaf * (i + 1));
      queue.writeBuffer(blobs, 4 * CHUNK_SPLATS * BLOB_WORDS * chunk, part(geometry, BLOB_WORDS));
      if (shRest) queue.writeBuffer(shRest, 4 * CHUNK_SPLATS * shWords * chunk, part(harmonics, shWords));
    }
    this.#writeErrors(placed);
  }

  #writeErrors({ cells, slot, above }: PlacedBrick): void {
    // Leaves and blobs of a cell end at the same error.
    const cellErrors = above?.childErrors.flatMap((error) => [error, error]);
    const own = emptyLinks(this.#nowhere, 2 * CELL_CHILDREN, cellErrors);
    for (const [i, { childErrors, childRoots }] of cells.entries()) {
      const leaves = ChunkLinks.words * 2 * i + HEAD_WORDS;
      for (const [k, roots] of childRoots.entries())
        own.fill(childErrors[k], leaves + CELL_ROOTS * k, leaves + CELL_ROOTS * k + roots);
    }
    const { links } = this.blobPages.at(-1)!;
    this.#context.device.queue.writeBuffer(links, LINKS_BYTES * 2 * CELL_CHILDREN * slot, own);
  }

  /** Adds dispatches that merge the blobs of a brick. */
  #merge(dispatches: Dispatches, { level, cells }: PlacedBrick): void {
    const { shDegree } = this.#scene;
    const page = this.blobPages.at(-1)!;
    const firstCell = cells[0].cell;
    if (level === 0) {
      this.#chunks.merge(dispatches, cells, firstCell, { start: this.chunkCells, page });
      return;
    }
    const parameters = MergeParameters.pack({
      firstCell,
      endCell: firstCell + cells.length,
      pageStart: 0,
      levelStart: 0,
      nextLevelStart: 0,
      upperStart: this.chunkCells,
      splatCount: 0,
      hasNextLevel: 0,
      dispatchRow: this.#context.dispatchRow,
    });
    const bindings = upperBindings(this.cells, page);
    for (const stage of mergeStages(shDegree).upper)
      dispatches.add(stage, parameters, bindings, cells.length);
  }

  /** Has the leaves of a cell drawn at any distance while the brick below it is missing. */
  #open(dispatches: Dispatches, { cell, below, childErrors }: PlacedCell): void {
    const errors = Array.from({ length: CELL_CHILDREN }, (_, k) => (below ? (childErrors[k] ?? 0) : 0));
    const chunk = 2 * (cell - this.chunkCells);
    const { links: upperLinks } = this.blobPages.at(-1)!;
    dispatches.add(openLeaves, OpenedLeaves.pack({ chunk, errors }), { upperLinks }, 1);
  }

  #clearLinks(kind: Kind, slot: number): void {
    if (kind === 'lowest') {
      this.#chunks.clear(CELL_CHILDREN * slot, CELL_CHILDREN);
      return;
    }
    const chunks = 2 * CELL_CHILDREN;
    const { links } = this.blobPages.at(-1)!;
    const noLinks = emptyLinks(this.#nowhere, chunks);
    this.#context.device.queue.writeBuffer(links, LINKS_BYTES * chunks * slot, noLinks);
  }

  /** Marks all slots as empty. */
  #clear(): void {
    const { queue } = this.#context.device;
    queue.writeBuffer(this.cells, LevelCell.bytes * this.#nowhere, nowhereCells(this.#nowhere, 1));
    for (let slot = 0; slot < this.slots.lowest; slot++) this.#clearLinks('lowest', slot);
    for (let slot = 0; slot < this.slots.upper; slot++) this.#clearLinks('upper', slot);
    this.#chunks.unbound(0, this.chunkCells);
  }

  #changed(): void {
    if (this.#cloud) this.#cloud.version++;
  }
}

type Kind = 'lowest' | 'upper';

function kindOf(level: number): Kind {
  return level === 0 ? 'lowest' : 'upper';
}

function stagesOf({ shDegree }: BrickScene, kind: Kind): readonly StageDefinition[] {
  const { chunks, upper } = mergeStages(shDegree);
  return [...(kind === 'lowest' ? chunks : upper), openLeaves];
}

/** Stages needed to place the root. */
export function rootStages(scene: BrickScene): readonly StageDefinition[] {
  return stagesOf(scene, scene.brickCount === 1 ? 'lowest' : 'upper');
}
