import type { Brick, BrickAddress, BrickCell, BrickScene } from '../../data/bricks/brick.ts';
import { SplatFileError } from '../../data/errors.ts';
import { CHUNK_WORDS } from '../../data/layout/chunk-words.ts';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import {
  ChunkLinks,
  LEVEL_CONSTANTS,
  LevelCell,
  MergeParameters,
  OpenedLeaves,
} from '../../data/layout/level-structs.ts';
import { GEOMETRY_WORDS } from '../../data/packing/geometry.ts';
import { shWordsPerSplat } from '../../data/packing/harmonics.ts';
import { BLOB_PRECISION } from '../../data/packing/precision.ts';
import type { ShDegree } from '../../data/splats/splat-set.ts';
import type { GpuMemory } from '../../gpu/gpu-memory.ts';
import type { Bindings, StageDefinition } from '../../gpu/pipelines.ts';
import { mergeChunks } from '../../gpu/stages/merge-chunks.ts';
import { mergeHarmonics } from '../../gpu/stages/merge-harmonics.ts';
import { openLeaves } from '../../gpu/stages/open-leaves.ts';
import { CloudPlanes } from '../cloud-planes.ts';
import { type DispatchContext, Dispatches } from '../ingest/dispatches.ts';
import type { BlobPage, Levels } from '../levels.ts';
import { SplatCloud, type SplatCloudOptions } from '../splat-cloud.ts';

const { CELL_CHILDREN, CELL_ROOTS, NO_CELL } = LEVEL_CONSTANTS;
/** Splats of a brick of the lowest level, and leaves of any other. */
const BRICK_LEAVES = CELL_CHILDREN * CHUNK_SPLATS;
/** Splats in bricks, and the blobs that the GPU makes of them. */
const PRECISION = { geometryPrecision: 'packed', shPrecision: 'u8' } as const;
const SPLAT_WORDS = GEOMETRY_WORDS[PRECISION.geometryPrecision];
const BLOB_WORDS = GEOMETRY_WORDS[BLOB_PRECISION.geometryPrecision];
const LINKS_BYTES = 4 * ChunkLinks.words;
const HEAD_WORDS = ChunkLinks.words - CHUNK_SPLATS;
/** Words of these fields in a `ChunkLinks`. */
const CELL_ERROR_WORD = 1;
const UNCOUNTED_WORD = 7;
/** Bounds that are in no frustum. */
const NOWHERE = 1e18;

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
  const shBytes = shDegree > 0 ? 4 * shWordsPerSplat(shDegree, PRECISION.shPrecision) : 0;
  const blobBytes = 4 * BLOB_WORDS + shBytes;
  const cellBytes = LevelCell.bytes + 2 * LINKS_BYTES;
  return {
    lowest:
      BRICK_LEAVES * (4 * SPLAT_WORDS + shBytes + blobBytes) +
      CELL_CHILDREN * (cellBytes + 4 * CHUNK_WORDS.count),
    upper: 2 * BRICK_LEAVES * blobBytes + CELL_CHILDREN * cellBytes,
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
  readonly splatLinks: readonly GPUBuffer[];
  readonly blobPages: readonly BlobPage[];
  readonly refinement = null;
  readonly #context: DispatchContext;
  readonly #memory: GpuMemory;
  readonly #scene: BrickScene;
  readonly #planes: CloudPlanes;
  readonly #rows: Uint32Array;
  /** Words of the `Chunk` structs of the splats. */
  #chunks: Float32Array<ArrayBuffer>;
  /** Slots of a page of the lowest level. */
  readonly #pageSlots: number;
  readonly #free: { readonly lowest: number[]; readonly upper: number[] };
  /** Bricks by slot. */
  readonly #placed: { readonly lowest: PlacedBrick[]; readonly upper: PlacedBrick[] } = {
    lowest: [],
    upper: [],
  };
  /** Links of sixteen chunks that hold nothing. */
  readonly #noLinks: Uint32Array<ArrayBuffer>;
  #cloud: SplatCloud | null = null;

  private constructor(context: DispatchContext, memory: GpuMemory, scene: BrickScene, slots: PoolSlots) {
    const { name, shDegree } = scene;
    const { limits } = context.device;
    this.#context = context;
    this.#memory = memory;
    this.#scene = scene;
    this.slots = slots;
    const usage = GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_SRC | GPUBufferUsage.COPY_DST;
    const buffer = (what: string, bytes: number) => memory.createBuffer(`${name} ${what}`, bytes, usage);
    const shWords = shDegree > 0 ? shWordsPerSplat(shDegree, PRECISION.shPrecision) : 0;
    const bindingBytes = Math.min(limits.maxStorageBufferBindingSize, limits.maxBufferSize);
    this.#pageSlots = Math.floor(bindingBytes / (4 * BRICK_LEAVES * Math.max(BLOB_WORDS, shWords)));
    // The last one is that of chunks that hold nothing: never in sight, and never drawn.
    this.cellCount = CELL_CHILDREN * (slots.lowest + slots.upper) + 1;
    this.chunkCells = CELL_CHILDREN * slots.lowest;
    this.cells = buffer('cells', LevelCell.bytes * this.cellCount);
    this.#noLinks = new Uint32Array(CELL_CHILDREN * ChunkLinks.words);
    for (let chunk = 0; chunk < CELL_CHILDREN; chunk++)
      this.#noLinks[chunk * ChunkLinks.words] = this.#nowhere;
    const ranges = Array.from({ length: Math.ceil(slots.lowest / this.#pageSlots) }, (_, page) => ({
      start: BRICK_LEAVES * this.#pageSlots * page,
      end: BRICK_LEAVES * Math.min(slots.lowest, this.#pageSlots * (page + 1)),
    }));
    const plane = (what: string, bytesPerSplat: number) =>
      ranges.map(({ start, end }, page) => buffer(`${what} ${page}`, bytesPerSplat * (end - start)));
    const chunkPlane = (what: string, bytesPerChunk: number) => plane(what, bytesPerChunk / CHUNK_SPLATS);
    this.#planes = new CloudPlanes(memory, name, {
      ...PRECISION,
      shDegree,
      ranges,
      chunks: chunkPlane('chunks', 4 * CHUNK_WORDS.count),
      geometry: plane('geometry', 4 * SPLAT_WORDS),
      harmonics: shDegree > 0 ? plane('spherical harmonics', 4 * shWords) : [],
    });
    this.splatLinks = chunkPlane('splat links', LINKS_BYTES);
    const blobPage = (what: string, splatCount: number): BlobPage => ({
      splatCount,
      chunkCount: splatCount / CHUNK_SPLATS,
      geometry: buffer(`${what} geometry`, 4 * BLOB_WORDS * splatCount),
      shRest: shDegree > 0 ? buffer(`${what} spherical harmonics`, 4 * shWords * splatCount) : null,
      chunks: this.cells,
      links: buffer(`${what} links`, (LINKS_BYTES * splatCount) / CHUNK_SPLATS),
    });
    this.blobPages = [
      ...ranges.map(({ start, end }, page) => blobPage(`blob ${page}`, end - start)),
      blobPage('upper blob', 2 * BRICK_LEAVES * slots.upper),
    ];
    this.#rows = new Uint32Array(BRICK_LEAVES * slots.lowest);
    this.#chunks = new Float32Array(CHUNK_WORDS.count * CELL_CHILDREN * slots.lowest);
    const downFrom = (count: number) => Array.from({ length: count }, (_, i) => count - 1 - i);
    this.#free = { lowest: downFrom(slots.lowest), upper: downFrom(slots.upper) };
  }

  /**
   * Makes an empty pool.
   *
   * @throws GpuLimitError if the device has no room for it; nothing is left allocated then.
   */
  static async make(context: DispatchContext, scene: BrickScene, slots: PoolSlots): Promise<BrickPool> {
    const memory = context.memory.part();
    await context.pipelines.prepare(stagesOf(scene.shDegree));
    const { result: pool, checked } = memory.guard(scene.name, 'Give it fewer bytes.', () => {
      try {
        const made = new BrickPool({ ...context, memory }, memory, scene, slots);
        made.#clear();
        return made;
      } catch (error) {
        memory.destroyAll();
        throw error;
      }
    });
    await checked?.catch((error) => {
      memory.destroyAll();
      throw error;
    });
    return pool;
  }

  /** The cloud of the scene. */
  cloud(options: Pick<SplatCloudOptions, 'onDestroyed'> = {}): SplatCloud {
    const { name, splatCount, origin, bounds, robustBounds, shDegree } = this.#scene;
    const facts = {
      declaredShDegree: shDegree,
      trueShDegree: shDegree,
      // What can be seen is not known before all is there.
      shBandReach: Array.from({ length: shDegree }, () => Number.POSITIVE_INFINITY),
      paletteEntries: null,
      isIsotropic: false,
      isAntialiased: this.#scene.isAntialiased ?? null,
      fileFacts: null,
    };
    const contents = {
      count: splatCount,
      origin,
      bounds,
      robustBounds,
      dropped: {},
      fileIndices: this.#rows,
      facts,
      chunks: this.#chunks.buffer,
      precision: PRECISION,
    };
    const cloud = new SplatCloud(this.#context.device, this.#planes, contents, {
      ...options,
      name,
      pool: this,
    });
    cloud.levels = this;
    this.#cloud = cloud;
    return cloud;
  }

  /** All but the planes of splats, which are the cloud's. */
  get bytes(): number {
    return this.#memory.report().totalBytes - this.#planes.bytes;
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
    this.#writeCells(placed);
    if (kind === 'lowest') this.#writeSplats(brick, placed);
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
    if (kind === 'lowest') this.#hideChunks(CELL_CHILDREN * slot, CELL_CHILDREN * (slot + 1));
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

  /** The page of a slot of the lowest level, and its first chunk there. */
  #placeOf(slot: number): { readonly page: number; readonly chunk: number } {
    const page = Math.floor(slot / this.#pageSlots);
    return { page, chunk: CELL_CHILDREN * (slot - page * this.#pageSlots) };
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

  #writeCells({ cells, above }: PlacedBrick): void {
    const contents = new ArrayBuffer(LevelCell.bytes * cells.length);
    for (const [i, { bounds }] of cells.entries()) {
      const parent = above?.cell ?? NO_CELL;
      LevelCell.write(
        contents,
        { minPosition: bounds.min, maxPosition: bounds.max, parent },
        LevelCell.bytes * i,
      );
    }
    this.#context.device.queue.writeBuffer(this.cells, LevelCell.bytes * cells[0].cell, contents);
  }

  /** Writes the splats of a brick of the lowest level. */
  #writeSplats({ cells, geometry, harmonics, rows }: Brick, { slot }: PlacedBrick): void {
    const { queue } = this.#context.device;
    const { page, chunk } = this.#placeOf(slot);
    const first = chunk * CHUNK_SPLATS;
    const { geometry: splats, shRest, chunks } = this.#planes.pagesFor(PRECISION).pages[page];
    queue.writeBuffer(splats, 4 * SPLAT_WORDS * first, geometry);
    if (shRest)
      queue.writeBuffer(shRest, ((4 * first * harmonics.length) / geometry.length) * SPLAT_WORDS, harmonics);
    this.#chunks = this.#chunks.slice();
    const start = CHUNK_WORDS.count * CELL_CHILDREN * slot;
    for (const [i, { bounds, logScales }] of cells.entries()) {
      const at = start + CHUNK_WORDS.count * i;
      this.#chunks.set(bounds.min, at + CHUNK_WORDS.minPosition);
      this.#chunks.set(bounds.max, at + CHUNK_WORDS.maxPosition);
      this.#chunks[at + CHUNK_WORDS.minLogScale] = logScales[0];
      this.#chunks[at + CHUNK_WORDS.logScaleStep] = logScales[1];
    }
    const words = CHUNK_WORDS.count * cells.length;
    queue.writeBuffer(chunks, 4 * CHUNK_WORDS.count * chunk, this.#chunks, start, words);
    this.#rows.set(rows, BRICK_LEAVES * slot);
    this.#clearLinks('lowest', slot);
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
      const own = this.#noLinks.slice(0, ChunkLinks.words);
      for (const [k, roots] of childRoots.entries())
        own.fill(childErrors[k], HEAD_WORDS + CELL_ROOTS * k, HEAD_WORDS + CELL_ROOTS * k + roots);
      queue.writeBuffer(links, LINKS_BYTES * chunk, own);
    }
  }

  /** Makes the blobs of a brick. */
  #merge(dispatches: Dispatches, { level, slot, cells }: PlacedBrick): void {
    const { shDegree } = this.#scene;
    const upper = this.blobPages.at(-1)!;
    const upperStart = this.chunkCells;
    const ofUpper = {
      cells: this.cells,
      upper: upper.geometry,
      upperLinks: upper.links,
      ...(upper.shRest && { upperSh: upper.shRest }),
    };
    const firstCell = cells[0].cell;
    const range = {
      firstCell,
      endCell: firstCell + cells.length,
      levelStart: 0,
      nextLevelStart: 0,
      upperStart,
      hasNextLevel: 0,
      dispatchRow: this.#context.dispatchRow,
    };
    if (level > 0) {
      const parameters = MergeParameters.pack({ ...range, pageStart: 0, splatCount: 0 });
      for (const stage of upperStages(shDegree)) dispatches.add(stage, parameters, ofUpper, cells.length);
      return;
    }
    const { page, chunk } = this.#placeOf(slot);
    const { geometry, shRest, chunks } = this.#planes.pagesFor(PRECISION).pages[page];
    const blobs = this.blobPages[page];
    const bindings: Bindings = {
      ...ofUpper,
      splats: geometry,
      chunks,
      splatLinks: this.splatLinks[page],
      blobs: blobs.geometry,
      blobLinks: blobs.links,
      ...(shRest && { shRest, blobSh: blobs.shRest! }),
    };
    const splatCount = CHUNK_SPLATS * (chunk + cells.length - 1) + cells.at(-1)!.leafCount;
    const pageStart = CELL_CHILDREN * this.#pageSlots * page;
    const parameters = MergeParameters.pack({ ...range, pageStart, splatCount });
    for (const stage of lowestStages(shDegree)) dispatches.add(stage, parameters, bindings, cells.length);
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
    const write = (links: GPUBuffer, chunk: number, word: number, value: number) =>
      queue.writeBuffer(links, LINKS_BYTES * chunk + 4 * word, Uint32Array.of(value));
    const { page, chunk } = this.#placeOf(slot);
    const upper = this.blobPages.at(-1)!.links;
    for (const [i, { leafCount }] of cells.entries()) {
      const leaves = 2 * (CELL_CHILDREN * slot + i);
      const places =
        level > 0
          ? ([
              [upper, leaves],
              [upper, leaves + 1],
            ] as const)
          : ([
              [this.splatLinks[page], chunk + i],
              [this.blobPages[page].links, chunk + i],
            ] as const);
      if (above) for (const [links, at] of places) write(links, at, CELL_ERROR_WORD, above.childErrors[i]);
      if (level === 0) write(...places[0], UNCOUNTED_WORD, CHUNK_SPLATS - leafCount);
    }
  }

  #clearLinks(kind: Kind, slot: number): void {
    const { queue } = this.#context.device;
    if (kind === 'lowest') {
      const { page, chunk } = this.#placeOf(slot);
      queue.writeBuffer(this.splatLinks[page], LINKS_BYTES * chunk, this.#noLinks);
      queue.writeBuffer(this.blobPages[page].links, LINKS_BYTES * chunk, this.#noLinks);
      return;
    }
    const { links } = this.blobPages.at(-1)!;
    const half = LINKS_BYTES * CELL_CHILDREN;
    for (const part of [0, 1]) queue.writeBuffer(links, half * (2 * slot + part), this.#noLinks);
  }

  /** Gives chunks bounds that are never in sight, for counts on the CPU. */
  #hideChunks(first: number, end: number): void {
    this.#chunks = this.#chunks.slice();
    for (let chunk = first; chunk < end; chunk++) {
      const at = CHUNK_WORDS.count * chunk;
      this.#chunks.fill(NOWHERE, at + CHUNK_WORDS.minPosition, at + CHUNK_WORDS.minPosition + 3);
      this.#chunks.fill(-NOWHERE, at + CHUNK_WORDS.maxPosition, at + CHUNK_WORDS.maxPosition + 3);
    }
  }

  /** Fills everything with nothing. */
  #clear(): void {
    const nowhere = LevelCell.pack({
      minPosition: [NOWHERE, NOWHERE, NOWHERE],
      maxPosition: [-NOWHERE, -NOWHERE, -NOWHERE],
      parent: this.#nowhere,
    });
    this.#context.device.queue.writeBuffer(this.cells, LevelCell.bytes * this.#nowhere, nowhere);
    for (let slot = 0; slot < this.slots.lowest; slot++) this.#clearLinks('lowest', slot);
    for (let slot = 0; slot < this.slots.upper; slot++) this.#clearLinks('upper', slot);
    this.#hideChunks(0, this.chunkCells);
  }

  #changed(): void {
    if (!this.#cloud) return;
    this.#cloud.chunks = this.#chunks.buffer;
    this.#cloud.version++;
  }
}

type Kind = 'lowest' | 'upper';

function kindOf(level: number): Kind {
  return level === 0 ? 'lowest' : 'upper';
}

function lowestStages(shDegree: ShDegree): readonly StageDefinition[] {
  const merging = mergeChunks(PRECISION.geometryPrecision);
  return shDegree > 0 ? [merging, mergeHarmonics(shDegree, PRECISION)] : [merging];
}

function upperStages(shDegree: ShDegree): readonly StageDefinition[] {
  const merging = mergeChunks('upper');
  return shDegree > 0 ? [merging, mergeHarmonics(shDegree, 'upper')] : [merging];
}

function stagesOf(shDegree: ShDegree): readonly StageDefinition[] {
  return [...lowestStages(shDegree), ...upperStages(shDegree), openLeaves];
}
