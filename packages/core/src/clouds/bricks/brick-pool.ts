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
import type { ShDegree } from '../../data/splats/splat-set.ts';
import type { GpuMemory } from '../../gpu/gpu-memory.ts';
import type { StageDefinition } from '../../gpu/pipelines.ts';
import { mergeChunks } from '../../gpu/stages/merge-chunks.ts';
import { mergeHarmonics } from '../../gpu/stages/merge-harmonics.ts';
import { openLeaves } from '../../gpu/stages/open-leaves.ts';
import { type DispatchContext, Dispatches } from '../ingest/dispatches.ts';
import type { BlobPage, Levels } from '../levels.ts';
import type { SplatCloud, SplatCloudOptions } from '../splat-cloud.ts';
import {
  BLOB_WORDS,
  CELL_ERROR_WORD,
  ChunkPages,
  chunkBytes,
  chunkStages,
  emptyLinks,
  LINKS_BYTES,
  makeBlobPage,
  nowhereCell,
  poolBuffer,
  shBytes,
  upperBindings,
  writeCells,
} from './chunk-pages.ts';
import { makePool, streamedCloud } from './make-pool.ts';

const { CELL_CHILDREN, CELL_ROOTS, NO_CELL } = LEVEL_CONSTANTS;
/** Splats of a brick of the lowest level, and leaves of any other. */
const BRICK_LEAVES = CELL_CHILDREN * CHUNK_SPLATS;
const HEAD_WORDS = ChunkLinks.words - CHUNK_SPLATS;

/** Bricks that a pool has room for. */
export interface PoolSlots {
  /** Of the lowest level, and of all others. */
  readonly lowest: number;
  readonly upper: number;
}

/** A cell of a brick on the GPU. */
export interface PlacedCell extends BrickCell {
  readonly brick: PlacedBrick;
  /** Its place among the cells of the pool. */
  readonly cell: number;
  /** The brick with the cells below; null while it is not on the GPU. */
  below: PlacedBrick | null;
}

/** A brick on the GPU. */
export interface PlacedBrick {
  readonly address: BrickAddress;
  readonly level: number;
  readonly slot: number;
  readonly cells: readonly PlacedCell[];
  /** The cell above; null for the root. */
  readonly above: PlacedCell | null;
}

/** Bytes that a slot of a pool takes: of the lowest level, and of any other. */
export function slotBytes(shDegree: ShDegree): { readonly lowest: number; readonly upper: number } {
  const blobBytes = 4 * BLOB_WORDS + shBytes(shDegree);
  return {
    lowest: CELL_CHILDREN * chunkBytes(shDegree),
    upper: 2 * BRICK_LEAVES * blobBytes + CELL_CHILDREN * (LevelCell.bytes + 2 * LINKS_BYTES),
  };
}

/**
 * Room on the GPU for bricks of one scene, which its cloud shows: bricks take the place of others,
 * and nothing is allocated once the pool is made. A brick is placed below its parent, whose leaves
 * stand for it before and after. Nothing here decides which bricks are there.
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
  /** Bricks by slot. */
  readonly #placed: { readonly lowest: PlacedBrick[]; readonly upper: PlacedBrick[] } = {
    lowest: [],
    upper: [],
  };
  #cloud: SplatCloud | null = null;

  private constructor(context: DispatchContext, memory: GpuMemory, scene: BrickScene, slots: PoolSlots) {
    const { name, shDegree } = scene;
    this.#context = context;
    this.#memory = memory;
    this.#scene = scene;
    this.slots = slots;
    // The last one is that of chunks that hold nothing: never in sight, and never drawn.
    this.cellCount = CELL_CHILDREN * (slots.lowest + slots.upper) + 1;
    this.chunkCells = CELL_CHILDREN * slots.lowest;
    this.cells = poolBuffer(memory, `${name} cells`, LevelCell.bytes * this.cellCount);
    this.#chunks = new ChunkPages(context, memory, scene, this.chunkCells, this.cells, this.#nowhere);
    const upperLeaves = 2 * BRICK_LEAVES * slots.upper;
    this.blobPages = [
      ...this.#chunks.blobPages,
      makeBlobPage(memory, `${name} upper blob`, shDegree, this.cells, upperLeaves),
    ];
    const downFrom = (count: number) => Array.from({ length: count }, (_, i) => count - 1 - i);
    this.#free = { lowest: downFrom(slots.lowest), upper: downFrom(slots.upper) };
  }

  /**
   * Makes an empty pool.
   *
   * @throws GpuLimitError if the device has no room for it; nothing is left allocated then.
   */
  static async make(context: DispatchContext, scene: BrickScene, slots: PoolSlots): Promise<BrickPool> {
    return makePool(context, scene, stagesOf(scene.shDegree), (memory) => {
      const made = new BrickPool({ ...context, memory }, memory, scene, slots);
      made.#clear();
      return made;
    });
  }

  get splatLinks(): readonly GPUBuffer[] {
    return this.#chunks.splatLinks;
  }

  /** The cloud of the scene. */
  cloud(options: Pick<SplatCloudOptions, 'onDestroyed'> = {}): SplatCloud {
    const cloud = streamedCloud(this.#context.device, this.#scene, this.#chunks, this, options);
    this.#cloud = cloud;
    return cloud;
  }

  /** All but the planes of splats, which are the cloud's. */
  get bytes(): number {
    return this.#memory.report().totalBytes - this.#chunks.planes.bytes;
  }

  /** Most splats and blobs that a frame draws of what is there. */
  get capacity(): number {
    return BRICK_LEAVES * (this.slots.lowest + this.slots.upper);
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
   * Puts a brick into a free slot, makes its blobs and draws it from then on where its parent is too
   * coarse.
   *
   * @param above the cell whose `child` the brick is; null for the root.
   * @throws SplatFileError if the brick does not fit its place; nothing is changed then.
   */
  place(brick: Brick, address: BrickAddress, above: PlacedCell | null): PlacedBrick {
    this.#check(brick, address, above);
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
    if (kind === 'lowest') this.#chunks.write(brick, start);
    else this.#writeLeaves(brick, placed);
    const dispatches = new Dispatches(this.#context);
    this.#merge(dispatches, placed);
    for (const cell of placed.cells) if (brick.level > 0) this.#open(dispatches, cell);
    dispatches.submit(`${this.#scene.name} brick`);
    this.#writeHeads(placed);
    if (above) {
      above.below = placed;
      const opening = new Dispatches(this.#context);
      this.#open(opening, above);
      opening.submit(`${this.#scene.name} brick`);
    }
    this.#changed();
    return placed;
  }

  /** Takes a brick out, and all that is below it; its parent stands for it. */
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

  childCell(cell: number, slot: number): number | null {
    const index = cell - this.chunkCells;
    const brick = this.#placed.upper[Math.floor(index / CELL_CHILDREN)];
    const below = brick?.cells[index % CELL_CHILDREN]?.below;
    return below?.cells[Math.floor(slot / CELL_ROOTS)]?.cell ?? null;
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

  /** Writes the leaves of a brick above, with the errors of their cells, for the merging. */
  #writeLeaves({ cells, geometry, harmonics }: Brick, { slot }: PlacedBrick): void {
    const { queue } = this.#context.device;
    const { geometry: blobs, shRest, links } = this.blobPages.at(-1)!;
    this.#clearLinks('upper', slot);
    const shWords = harmonics.length / (geometry.length / BLOB_WORDS);
    for (const [i, { childErrors, childRoots }] of cells.entries()) {
      const chunk = 2 * (CELL_CHILDREN * slot + i);
      const part = (words: Uint32Array<ArrayBuffer>, perLeaf: number) =>
        words.subarray(CHUNK_SPLATS * perLeaf * i, CHUNK_SPLATS * perLeaf * (i + 1));
      queue.writeBuffer(blobs, 4 * CHUNK_SPLATS * BLOB_WORDS * chunk, part(geometry, BLOB_WORDS));
      if (shRest) queue.writeBuffer(shRest, 4 * CHUNK_SPLATS * shWords * chunk, part(harmonics, shWords));
      const own = emptyLinks(this.#nowhere, 1);
      for (const [k, roots] of childRoots.entries())
        own.fill(childErrors[k], HEAD_WORDS + CELL_ROOTS * k, HEAD_WORDS + CELL_ROOTS * k + roots);
      queue.writeBuffer(links, LINKS_BYTES * chunk, own);
    }
  }

  /** Makes the blobs of a brick. */
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
    for (const stage of upperStages(shDegree)) dispatches.add(stage, parameters, bindings, cells.length);
  }

  /** Lets the leaves of a cell stand for the brick below, or not. */
  #open(dispatches: Dispatches, { cell, below, childErrors }: PlacedCell): void {
    const errors = Array.from({ length: CELL_CHILDREN }, (_, k) => (below ? (childErrors[k] ?? 0) : 0));
    const chunk = 2 * (cell - this.chunkCells);
    const { links: upperLinks } = this.blobPages.at(-1)!;
    dispatches.add(openLeaves, OpenedLeaves.pack({ chunk, errors }), { upperLinks }, 1);
  }

  /**
   * Writes what merging does not know: the errors at which cells end and the leaves above begin,
   * whatever the GPU has found for them, and how many splats a chunk lacks.
   */
  #writeHeads({ level, slot, cells, above }: PlacedBrick): void {
    const { queue } = this.#context.device;
    const { links } = this.blobPages.at(-1)!;
    for (const [i, cell] of cells.entries()) {
      const error = above?.childErrors[i];
      if (level === 0) this.#chunks.writeHead(cell, cell.cell, error);
      else if (error !== undefined) {
        const chunk = 2 * (CELL_CHILDREN * slot + i);
        for (const at of [chunk, chunk + 1])
          queue.writeBuffer(links, LINKS_BYTES * at + 4 * CELL_ERROR_WORD, Uint32Array.of(error));
      }
    }
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

  /** Fills everything with nothing. */
  #clear(): void {
    const { queue } = this.#context.device;
    queue.writeBuffer(this.cells, LevelCell.bytes * this.#nowhere, nowhereCell(this.#nowhere));
    for (let slot = 0; slot < this.slots.lowest; slot++) this.#clearLinks('lowest', slot);
    for (let slot = 0; slot < this.slots.upper; slot++) this.#clearLinks('upper', slot);
    this.#chunks.unbound(0, this.chunkCells);
  }

  #changed(): void {
    if (!this.#cloud) return;
    this.#cloud.chunks = this.#chunks.words.buffer;
    this.#cloud.version++;
  }
}

type Kind = 'lowest' | 'upper';

function kindOf(level: number): Kind {
  return level === 0 ? 'lowest' : 'upper';
}

function upperStages(shDegree: ShDegree): readonly StageDefinition[] {
  const merging = mergeChunks('upper');
  return shDegree > 0 ? [merging, mergeHarmonics(shDegree, 'upper')] : [merging];
}

function stagesOf(shDegree: ShDegree): readonly StageDefinition[] {
  return [...chunkStages(shDegree), ...upperStages(shDegree), openLeaves];
}
