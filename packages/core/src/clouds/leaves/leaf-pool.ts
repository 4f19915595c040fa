import type { BrickCell } from '../../data/bricks/brick.ts';
import type { SplatCells } from '../../data/bricks/leaf-scene.ts';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { LEVEL_CONSTANTS, LevelCell } from '../../data/layout/level-structs.ts';
import { GEOMETRY_WORDS } from '../../data/packing/geometry.ts';
import type { GpuMemory } from '../../gpu/gpu-memory.ts';
import { type DispatchContext, Dispatches } from '../ingest/dispatches.ts';
import type { BlobPage, Levels } from '../levels.ts';
import type { CloudPool, SplatCloud, SplatCloudOptions } from '../splat-cloud.ts';
import {
  type ChunkMove,
  ChunkPages,
  chunkBytes,
  emptyLinks,
  freeBlobPage,
  makeBlobPage,
  mergeStages,
  nowhereCells,
  poolBuffer,
  shBytes,
  writeCells,
} from '../stream/chunk-pages.ts';
import { makePool, resizedPool, type StreamedScene, streamedCloud } from '../stream/make-pool.ts';

/** Upper chunks of the pool: the two of the one empty cell. */
const UPPER_CHUNKS = 2;

/** Cells in successive slots. */
interface Run {
  readonly cells: readonly BrickCell[];
  readonly first: number;
}

/** Splats of one piece on the GPU. */
export interface PlacedSplats {
  /** Changes when the pool is resized. */
  runs: readonly Run[];
  readonly chunkCount: number;
  readonly level: number;
  isShown: boolean;
}

/**
 * GPU memory for levels of the leaves of one scene, drawn by its cloud. Each chunk of splats is
 * merged to roots of its own, so the levels form a forest. Chunks take any free slots. Nothing is
 * allocated once the pool is made; the caller alone decides which levels are resident.
 */
export class LeafPool implements Levels, CloudPool {
  readonly cellCount: number;
  readonly chunkCells: number;
  readonly cells: GPUBuffer;
  readonly blobPages: readonly BlobPage[];
  readonly refinement = null;
  readonly #context: DispatchContext;
  readonly #memory: GpuMemory;
  readonly #scene: StreamedScene;
  readonly #chunks: ChunkPages;
  /** Per chunk. */
  readonly #isTaken: Uint8Array;
  /** Level of the leaf, per chunk. */
  readonly #levels: Uint8Array;
  #takenChunks = 0;
  readonly #placed = new Set<PlacedSplats>();
  #cloud: SplatCloud | null = null;

  /** @param before a pool whose splats move into this one; they must fit. */
  private constructor(
    context: DispatchContext,
    memory: GpuMemory,
    scene: StreamedScene,
    chunkCount: number,
    before: LeafPool | null = null,
  ) {
    const { name, shDegree } = scene;
    this.#context = context;
    this.#memory = memory;
    this.#scene = scene;
    this.chunkCells = chunkCount;
    this.cellCount = chunkCount + 1;
    this.cells = poolBuffer(memory, `${name} cells`, LevelCell.bytes * this.cellCount);
    // Blobs are freed first and merged again, so that two pools fit in memory.
    if (before) before.#freeOthers();
    this.#chunks = new ChunkPages(
      context,
      memory,
      scene,
      chunkCount,
      this.cells,
      chunkCount,
      before && { pages: before.#chunks, moves: before.#moves },
    );
    this.blobPages = [
      ...this.#chunks.blobPages,
      makeBlobPage(memory, `${name} upper blob`, shDegree, this.cells, UPPER_CHUNKS * CHUNK_SPLATS),
    ];
    this.#isTaken = new Uint8Array(chunkCount);
    this.#levels = new Uint8Array(chunkCount);
  }

  /**
   * Makes an empty pool.
   *
   * @throws GpuLimitError if the device has no room for it; nothing is left allocated then.
   */
  static make(context: DispatchContext, scene: StreamedScene, chunkCount: number): Promise<LeafPool> {
    return makePool(context, scene, mergeStages(scene.shDegree).chunks, (memory) => {
      const made = new LeafPool({ ...context, memory }, memory, scene, chunkCount);
      made.#clear();
      return made;
    });
  }

  /** Makes the cloud that draws this pool. */
  cloud(options: Pick<SplatCloudOptions, 'onDestroyed'> = {}): SplatCloud {
    this.#cloud = streamedCloud(this.#context.device, this.#scene, this.#chunks, this, options);
    return this.#cloud;
  }

  /** Resizes like `BrickPool.resized`. */
  resized(chunkCount: number): LeafPool {
    const growth = (chunkCount - this.chunkCells) * chunkBytes(this.#scene.shDegree);
    return (
      resizedPool(this.#memory, this.#cloud!, growth, () => {
        const pool = new LeafPool(this.#context, this.#memory, this.#scene, chunkCount, this);
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

  /** Bytes of the pool without the planes of splats, which the cloud counts. */
  get bytes(): number {
    return this.#memory.report().totalBytes - this.#chunks.planes.bytes;
  }

  /** Most splats and blobs that one frame can draw from this pool. */
  get capacity(): number {
    return CHUNK_SPLATS * this.chunkCells;
  }

  get chunks(): ArrayBuffer {
    return this.#chunks.words.buffer;
  }

  get freeChunks(): number {
    return this.chunkCells - this.#takenChunks;
  }

  /**
   * Writes splats into free chunks, of which there must be enough, and merges their blobs. `show`
   * draws them.
   *
   * @param level level of the leaf; 0 is the finest.
   */
  place(piece: SplatCells, level: number): PlacedSplats {
    const placed = { runs: this.#write(piece), chunkCount: piece.cells.length, level, isShown: false };
    this.#placed.add(placed);
    this.#merge(placed);
    return placed;
  }

  /** Merges the blobs of splats. */
  #merge({ runs, level }: PlacedSplats): void {
    for (const { cells, first } of runs) this.#levels.fill(level, first, first + cells.length);
    const dispatches = new Dispatches(this.#context);
    const upper = { start: this.chunkCells, page: this.blobPages.at(-1)! };
    for (const { cells, first } of runs) this.#chunks.merge(dispatches, cells, first, upper);
    dispatches.submit(`${this.#scene.name} leaf`);
    this.#hide(runs);
  }

  /** Draws placed splats, or hides them without removing them. */
  show(placed: PlacedSplats, isShown: boolean): void {
    placed.isShown = isShown;
    if (!isShown) this.#hide(placed.runs);
    else
      for (const { cells, first } of placed.runs) {
        writeCells(this.#context.device, this.cells, cells, first, LEVEL_CONSTANTS.NO_CELL);
        this.#chunks.bound(cells, first);
      }
    this.#changed();
  }

  /** Moves the cells of chunks out of every frustum. */
  #hide(runs: readonly Run[]): void {
    const { queue } = this.#context.device;
    for (const { cells, first } of runs) {
      queue.writeBuffer(this.cells, LevelCell.bytes * first, nowhereCells(this.chunkCells, cells.length));
      this.#chunks.unbound(first, first + cells.length);
    }
  }

  remove(placed: PlacedSplats): void {
    const { runs, chunkCount } = placed;
    this.#placed.delete(placed);
    for (const { cells, first } of runs) {
      this.#chunks.clear(first, cells.length);
      this.#chunks.unbound(first, first + cells.length);
      this.#isTaken.fill(0, first, first + cells.length);
    }
    this.#takenChunks -= chunkCount;
    this.#changed();
  }

  levelOf(cell: number): number {
    return this.#levels[cell] ?? 0;
  }

  childCell(): null {
    return null;
  }

  /** Resolves when the GPU has finished all submitted work. */
  whenDone(): Promise<unknown> {
    return this.#context.device.queue.onSubmittedWorkDone();
  }

  destroy(): void {
    this.#memory.destroyAll();
  }

  /** Writes a piece into the first free chunks. */
  #write({ cells, geometry, harmonics, rows }: SplatCells): Run[] {
    const { pageChunks } = this.#chunks;
    const runs: Run[] = [];
    for (let from = 0; from < cells.length; ) {
      const first = this.#isTaken.indexOf(0);
      let to = from;
      let chunk = first;
      do {
        this.#isTaken[chunk++] = 1;
        to++;
      } while (to < cells.length && this.#isTaken[chunk] === 0 && chunk % pageChunks !== 0);
      const part = (words: Uint32Array<ArrayBuffer>, perSplat: number) =>
        words.subarray(CHUNK_SPLATS * perSplat * from, CHUNK_SPLATS * perSplat * to);
      const run = { cells: cells.slice(from, to), first };
      writeCells(this.#context.device, this.cells, run.cells, first, LEVEL_CONSTANTS.NO_CELL);
      this.#chunks.write(
        {
          cells: run.cells,
          geometry: part(geometry, GEOMETRY_WORDS.packed),
          harmonics: part(harmonics, shBytes(this.#scene.shDegree) / 4),
          rows: part(rows, 1),
        },
        first,
      );
      runs.push(run);
      from = to;
    }
    this.#takenChunks += cells.length;
    return runs;
  }

  /**
   * The copies that compact the splats for a resized pool: in order, each page filled from its
   * start.
   */
  get #moves(): ChunkMove[] {
    const moves: ChunkMove[] = [];
    let to = 0;
    for (const { runs } of this.#placed)
      for (const { cells, first } of runs)
        for (let done = 0; done < cells.length; ) {
          const { pageChunks } = this.#chunks;
          const count = Math.min(cells.length - done, pageChunks - (to % pageChunks));
          moves.push({ from: first + done, to, count });
          done += count;
          to += count;
        }
    return moves;
  }

  /** Takes over the splats of another pool, which have been copied as its moves say. */
  #takeOver(before: LeafPool): void {
    const moves = before.#moves.values();
    for (const placed of before.#placed) {
      const runs: Run[] = [];
      for (const { cells } of placed.runs)
        for (let done = 0; done < cells.length; ) {
          const { from, to, count } = moves.next().value!;
          const run = { cells: cells.slice(done, done + count), first: to };
          const rows = before.#chunks.rows.subarray(CHUNK_SPLATS * from, CHUNK_SPLATS * (from + count));
          writeCells(this.#context.device, this.cells, run.cells, to, LEVEL_CONSTANTS.NO_CELL);
          this.#chunks.keep({ cells: run.cells, rows }, to);
          this.#isTaken.fill(1, to, to + count);
          runs.push(run);
          done += count;
        }
      placed.runs = runs;
      this.#placed.add(placed);
      this.#takenChunks += placed.chunkCount;
      this.#merge(placed);
      if (placed.isShown) this.show(placed, true);
    }
  }

  /** Frees all buffers except the planes of splats. */
  #freeOthers(): void {
    this.#chunks.freeBlobs();
    freeBlobPage(this.#memory, this.blobPages.at(-1)!);
    this.#memory.destroy(this.cells);
  }

  /** Marks all slots as empty. */
  #clear(): void {
    const { queue } = this.#context.device;
    const nowhere = this.chunkCells;
    queue.writeBuffer(this.cells, LevelCell.bytes * nowhere, nowhereCells(nowhere, 1));
    queue.writeBuffer(this.blobPages.at(-1)!.links, 0, emptyLinks(nowhere, UPPER_CHUNKS));
    const { pageChunks } = this.#chunks;
    for (let first = 0; first < nowhere; first += pageChunks)
      this.#chunks.clear(first, Math.min(pageChunks, nowhere - first));
    this.#chunks.unbound(0, nowhere);
  }

  #changed(): void {
    if (this.#cloud) this.#cloud.version++;
  }
}
