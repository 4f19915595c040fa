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
import { chunkCountOf } from '../../data/packing/chunks.ts';
import type { ShDegree } from '../../data/splats/splat-set.ts';
import type { StageDefinition } from '../../gpu/pipelines.ts';
import { openLeaves } from '../../stages/cut/cut.ts';
import { type DispatchContext, Dispatches } from '../ingest/dispatches.ts';
import {
  BLOB_WORDS,
  chunkBytes,
  emptyLinks,
  LINKS_BYTES,
  mergeStages,
  shBytes,
  upperBindings,
} from '../stream/chunk-pages.ts';
import {
  type Chunks,
  type JoinedChunks,
  joined,
  makePool,
  type ReplacedPool,
  ScenePool,
  type StreamedScene,
  WRITTEN_AT_ONCE,
} from '../stream/scene-pool.ts';

const { CELL_CHILDREN, CELL_ROOTS, NO_CELL, OPENED_CELLS } = LEVEL_CONSTANTS;
const HEAD_WORDS = ChunkLinks.words - CHUNK_SPLATS;
/**
 * Share of a pool for upper bricks. They are a sixteenth of a whole scene, and more of a partly
 * resident one.
 */
const UPPER_PART = 1 / 6;

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
export class BrickPool extends ScenePool {
  readonly slots: PoolSlots;
  readonly #free: Readonly<Record<Kind, number[]>>;
  /** Indexed by slot. */
  readonly #placed: Readonly<Record<Kind, PlacedBrick[]>> = { lowest: [], upper: [] };
  /** Placed bricks whose cells have not been written, and bricks whose blobs have not been merged. */
  readonly #unwritten = new Set<PlacedBrick>();
  readonly #unmerged = new Set<PlacedBrick>();
  /** Cells above bricks that were placed or removed. */
  readonly #changed = new Set<PlacedCell>();

  /**
   * @param before a smaller or larger pool whose bricks move into the first slots; they must fit.
   */
  private constructor(context: DispatchContext, scene: StreamedScene, slots: PoolSlots, before?: BrickPool) {
    const shape = { chunkCells: CELL_CHILDREN * slots.lowest, upperCells: CELL_CHILDREN * slots.upper };
    super(context, scene, shape, before && { pool: before, ...before.#moves });
    this.slots = slots;
    const downFrom = (count: number) => Array.from({ length: count }, (_, i) => count - 1 - i);
    this.#free = { lowest: downFrom(slots.lowest), upper: downFrom(slots.upper) };
    if (before) this.#takeOver(before);
  }

  /** The copies that move all bricks into the first slots of another pool. */
  get #moves(): Omit<ReplacedPool, 'pool'> {
    // `Object.values` skips free slots.
    const moves = (kind: Kind, chunksOf: (brick: PlacedBrick) => number, slotChunks: number) =>
      Object.values(this.#placed[kind]).map((brick, i) => ({
        from: slotChunks * brick.slot,
        to: slotChunks * i,
        count: chunksOf(brick),
      }));
    return {
      moves: moves('lowest', ({ cells }) => cells.length, CELL_CHILDREN),
      upperMoves: moves('upper', () => 2 * CELL_CHILDREN, 2 * CELL_CHILDREN),
    };
  }

  /**
   * Makes an empty pool.
   *
   * @throws GpuLimitError if the device has no room for it; nothing is left allocated then.
   */
  static make(context: DispatchContext, scene: BrickScene, slots: PoolSlots): Promise<BrickPool> {
    return makePool(context, scene, rootStages(scene), (own) => new BrickPool(own, scene, slots));
  }

  /**
   * Resolves when the shaders for placing bricks of a level are compiled. The root's are compiled
   * before the pool exists.
   */
  ready(level: number): Promise<void> {
    return this.context.pipelines.prepare(stagesOf(this.scene, kindOf(level)));
  }

  /**
   * The pool that replaces this one, in its cloud, with other slots and all of its bricks; this pool
   * if the engine's memory budget has no room for the other.
   */
  resized(slots: PoolSlots): BrickPool {
    this.merge();
    const [bytes, held] = [slots, this.slots].map((each) => poolBytes(this.scene.shDegree, each));
    return this.replaced(bytes - held, () => new BrickPool(this.context, this.scene, slots, this)) ?? this;
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
   * Places a brick in a free slot. It is drawn wherever its parent is too coarse after `merge`.
   * `ready` must have resolved.
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
    if (kind === 'lowest') this.pages.writeSplats(brick, start);
    else this.#writeLeaves(brick, placed);
    if (above) {
      above.below = placed;
      this.#changed.add(above);
    }
    this.#unmerged.add(placed);
    this.#unwritten.add(placed);
    if (CELL_CHILDREN * this.#unwritten.size >= WRITTEN_AT_ONCE) this.#write();
    return placed;
  }

  /**
   * Merges the blobs of all bricks placed since the last call, and has them drawn. Call it after
   * changes and before the next frame.
   */
  merge(): void {
    if (this.#unmerged.size === 0 && this.#changed.size === 0) return;
    this.#write();
    this.#activate([...this.#unmerged], this.#changed);
    this.#unmerged.clear();
    this.#changed.clear();
    this.onChanged();
  }

  /**
   * Removes a brick and all of its descendants; after `merge`, its parent's leaves are drawn
   * instead.
   */
  remove(brick: PlacedBrick): void {
    if (this.#unmerged.delete(brick)) this.#write();
    for (const cell of brick.cells) {
      if (cell.below) this.remove(cell.below);
      this.#changed.delete(cell);
    }
    const { above, slot, level } = brick;
    const kind = kindOf(level);
    if (above) {
      above.below = null;
      this.#changed.add(above);
    }
    if (kind === 'lowest') this.pages.clear(CELL_CHILDREN * slot, CELL_CHILDREN);
    else this.writeUpperLinks(2 * CELL_CHILDREN * slot, emptyLinks(this.nowhere, 2 * CELL_CHILDREN));
    delete this.#placed[kind][slot];
    this.#free[kind].push(slot);
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

  #firstCell(kind: Kind, slot: number): number {
    return CELL_CHILDREN * slot + (kind === 'lowest' ? 0 : this.chunkCells);
  }

  #check({ level, cells }: Brick, { number }: BrickAddress, above: PlacedCell | null): void {
    const wrong = (found: string) => {
      throw new SplatFileError(
        'damaged',
        this.scene.name,
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

  /** Writes the cells of placed bricks: one group of writes per run of adjacent slots. */
  #write(): void {
    for (const { first, parts } of this.#joined([...this.#unwritten])) {
      const cells = parts.flatMap(({ brick }) => brick.cells);
      this.writeCells(cells, first, ({ brick }) => brick.above?.cell ?? NO_CELL);
      if (first < this.chunkCells)
        this.pages.writeCells(
          cells,
          first,
          parts.flatMap(({ brick }) => brick.above?.childErrors ?? [0]),
        );
    }
    this.#unwritten.clear();
  }

  /** Runs of cells of adjacent bricks. */
  #joined(bricks: readonly PlacedBrick[]): readonly JoinedChunks<Chunks & { readonly brick: PlacedBrick }>[] {
    return joined(
      bricks.map((brick) => {
        const first = brick.cells[0].cell;
        const pageEnd = brick.level === 0 ? this.pages.pageEnd(first) : this.nowhere;
        return { first, count: brick.cells.length, pageEnd, brick };
      }),
    );
  }

  /**
   * Merges the blobs of placed bricks, whose cells were written, and opens their cells and others for
   * drawing.
   */
  #activate(bricks: readonly PlacedBrick[], others: Iterable<PlacedCell>): void {
    const dispatches = new Dispatches(this.context);
    for (const { first, count } of this.#joined(bricks))
      if (first < this.chunkCells) this.mergeChunks(dispatches, first, count);
      else this.#mergeUpper(dispatches, first, count);
    const own = bricks.flatMap(({ level, cells }) => (level > 0 ? cells : []));
    this.#open(dispatches, [...new Set([...own, ...others])]);
    dispatches.submit(`${this.scene.name} bricks`);
  }

  /**
   * Takes over the bricks of another pool. Their splats and leaves must have been copied, in the
   * same order.
   */
  #takeOver(before: BrickPool): void {
    for (const kind of ['lowest', 'upper'] as const)
      for (const brick of Object.values(before.#placed[kind])) {
        const slot = this.#free[kind].pop()!;
        const start = this.#firstCell(kind, slot);
        if (kind === 'lowest') {
          const first = CHUNK_SPLATS * CELL_CHILDREN * brick.slot;
          const end = first + CHUNK_SPLATS * brick.cells.length;
          this.pages.keepFileIndices(before.pages.fileIndices.subarray(first, end), start);
        }
        brick.slot = slot;
        for (const [i, cell] of brick.cells.entries()) cell.cell = start + i;
        this.#placed[kind][slot] = brick;
      }
    for (const brick of this.bricks) {
      this.#unwritten.add(brick);
      if (brick.level > 0) this.#writeErrors(brick);
      this.#write();
      // One by one: a whole pool could keep slow devices busy for seconds.
      this.#activate([brick], []);
    }
  }

  /** Writes the leaves of an upper brick with the errors of their cells, as input for merging. */
  #writeLeaves({ cells, geometry, harmonics }: Brick, placed: PlacedBrick): void {
    const { queue } = this.context.device;
    const { geometry: blobs, shRest } = this.upperPage;
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
    const own = emptyLinks(this.nowhere, 2 * CELL_CHILDREN, cellErrors);
    for (const [i, { childErrors, childRoots }] of cells.entries()) {
      const leaves = ChunkLinks.words * 2 * i + HEAD_WORDS;
      for (const [k, roots] of childRoots.entries())
        own.fill(childErrors[k], leaves + CELL_ROOTS * k, leaves + CELL_ROOTS * k + roots);
    }
    this.writeUpperLinks(2 * CELL_CHILDREN * slot, own);
  }

  /** Adds dispatches that merge the blobs of cells above the chunks. */
  #mergeUpper(dispatches: Dispatches, firstCell: number, count: number): void {
    const parameters = MergeParameters.pack({
      firstCell,
      endCell: firstCell + count,
      pageStart: 0,
      levelStart: 0,
      nextLevelStart: 0,
      upperStart: this.chunkCells,
      splatCount: 0,
      hasNextLevel: 0,
      dispatchRow: this.context.dispatchRow,
    });
    const bindings = upperBindings(this.cells, this.upperPage);
    for (const stage of mergeStages(this.scene.shDegree).upper)
      dispatches.add(stage, parameters, bindings, count);
  }

  /** Has the leaves of cells drawn at any distance while the bricks below them are missing. */
  #open(dispatches: Dispatches, cells: readonly PlacedCell[]): void {
    const { links: upperLinks } = this.upperPage;
    const { dispatchRow } = this.context;
    for (let from = 0; from < cells.length; from += OPENED_CELLS) {
      const opened = cells.slice(from, from + OPENED_CELLS);
      const errors = new Uint32Array(CELL_CHILDREN * OPENED_CELLS);
      const chunks = new Uint32Array(OPENED_CELLS);
      for (const [i, { cell, below, childErrors }] of opened.entries()) {
        if (below) errors.set(childErrors, CELL_CHILDREN * i);
        chunks[i] = 2 * (cell - this.chunkCells);
      }
      const parameters = OpenedLeaves.pack({ errors, chunks, count: opened.length, dispatchRow });
      dispatches.add(openLeaves, parameters, { upperLinks }, opened.length);
    }
  }
}

type Kind = 'lowest' | 'upper';

function kindOf(level: number): Kind {
  return level === 0 ? 'lowest' : 'upper';
}

function stagesOf({ shDegree }: StreamedScene, kind: Kind): readonly StageDefinition[] {
  const { chunks, upper } = mergeStages(shDegree);
  return [...(kind === 'lowest' ? chunks : upper), openLeaves];
}

/** Stages needed to place the root. */
export function rootStages(scene: BrickScene): readonly StageDefinition[] {
  return stagesOf(scene, scene.brickCount === 1 ? 'lowest' : 'upper');
}

/** Capacity of a pool in bricks. */
export interface PoolSlots {
  /** Bricks of the lowest level; `upper` counts bricks of all other levels. */
  readonly lowest: number;
  readonly upper: number;
}

/** Bytes per slot of a pool, for bricks of the lowest level and of any other. */
export function slotBytes(shDegree: ShDegree): { readonly lowest: number; readonly upper: number } {
  const blobBytes = 4 * BLOB_WORDS + shBytes(shDegree);
  return {
    lowest: CELL_CHILDREN * chunkBytes(shDegree),
    upper: CELL_CHILDREN * (LevelCell.bytes + 2 * (CHUNK_SPLATS * blobBytes + LINKS_BYTES)),
  };
}

/** Bytes of a pool with these slots. */
export function poolBytes(shDegree: ShDegree, { lowest, upper }: PoolSlots): number {
  const bytes = slotBytes(shDegree);
  return lowest * bytes.lowest + upper * bytes.upper + LevelCell.bytes;
}

/** Slots for the whole scene, or as many as the budget holds. */
export function slotsFor(scene: BrickScene, budgetBytes: number): PoolSlots {
  const { shDegree } = scene;
  const { least, most } = roomFor(scene);
  if (poolBytes(shDegree, most) <= budgetBytes) return most;
  const bytes = slotBytes(shDegree);
  const upper = Math.max(least.upper, Math.floor((UPPER_PART * budgetBytes) / bytes.upper));
  const slots = { lowest: 0, upper: Math.min(most.upper, upper) };
  return { ...slots, lowest: Math.floor((budgetBytes - poolBytes(shDegree, slots)) / bytes.lowest) };
}

/** Slots for the coarsest drawable state of a scene, and slots for all of it. */
export function roomFor({
  splatCount,
  brickCount,
}: BrickScene): Readonly<Record<'least' | 'most', PoolSlots>> {
  const chunks = chunkCountOf(splatCount);
  const lowest = Math.ceil(chunks / CELL_CHILDREN);
  const most = { lowest, upper: Math.max(1, brickCount - lowest) };
  // One brick of each level from the root down, and one spare to replace another.
  const levels = Math.ceil(Math.log(chunks) / Math.log(CELL_CHILDREN)) + 1;
  return { least: { lowest: Math.min(2, lowest), upper: Math.min(levels, most.upper) }, most };
}
