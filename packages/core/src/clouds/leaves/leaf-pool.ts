import type { BrickCell } from '../../data/bricks/brick.ts';
import type { SplatCells } from '../../data/bricks/leaf-scene.ts';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { LEVEL_CONSTANTS, LevelCell } from '../../data/layout/level-structs.ts';
import { GEOMETRY_WORDS } from '../../data/packing/geometry.ts';
import type { GpuMemory } from '../../gpu/gpu-memory.ts';
import {
  ChunkPages,
  chunkStages,
  emptyLinks,
  makeBlobPage,
  nowhereCell,
  poolBuffer,
  shBytes,
  writeCells,
} from '../bricks/chunk-pages.ts';
import { makePool, type StreamedScene, streamedCloud } from '../bricks/make-pool.ts';
import { type DispatchContext, Dispatches } from '../ingest/dispatches.ts';
import type { BlobPage, Levels } from '../levels.ts';
import type { CloudPool, SplatCloud, SplatCloudOptions } from '../splat-cloud.ts';

/** Chunks above those of splats: those of the one cell that holds nothing. */
const UPPER_CHUNKS = 2;

/** Cells in places that follow each other. */
interface Run {
  readonly cells: readonly BrickCell[];
  readonly first: number;
}

/** Splats on the GPU. */
export interface PlacedSplats {
  readonly runs: readonly Run[];
  readonly chunkCount: number;
}

/**
 * Room on the GPU for levels of leaves of one scene, which its cloud shows: a forest, in which each
 * chunk of splats is merged to its own roots. Chunks take any free places. Nothing is allocated
 * once the pool is made, and nothing here decides what is there.
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
  /** Whether each chunk is taken. */
  readonly #isTaken: Uint8Array;
  #takenChunks = 0;
  #cloud: SplatCloud | null = null;

  private constructor(context: DispatchContext, memory: GpuMemory, scene: StreamedScene, chunkCount: number) {
    const { name, shDegree } = scene;
    this.#context = context;
    this.#memory = memory;
    this.#scene = scene;
    this.chunkCells = chunkCount;
    this.cellCount = chunkCount + 1;
    this.cells = poolBuffer(memory, `${name} cells`, LevelCell.bytes * this.cellCount);
    this.#chunks = new ChunkPages(context, memory, scene, chunkCount, this.cells, chunkCount);
    this.blobPages = [
      ...this.#chunks.blobPages,
      makeBlobPage(memory, `${name} upper blob`, shDegree, this.cells, UPPER_CHUNKS * CHUNK_SPLATS),
    ];
    this.#isTaken = new Uint8Array(chunkCount);
  }

  /**
   * Makes an empty pool.
   *
   * @throws GpuLimitError if the device has no room for it; nothing is left allocated then.
   */
  static make(context: DispatchContext, scene: StreamedScene, chunkCount: number): Promise<LeafPool> {
    return makePool(context, scene, chunkStages(scene.shDegree), (memory) => {
      const made = new LeafPool({ ...context, memory }, memory, scene, chunkCount);
      made.#clear();
      return made;
    });
  }

  /** The cloud of the scene. */
  cloud(options: Pick<SplatCloudOptions, 'onDestroyed'> = {}): SplatCloud {
    this.#cloud = streamedCloud(this.#context.device, this.#scene, this.#chunks, this, options);
    return this.#cloud;
  }

  get splatLinks(): readonly GPUBuffer[] {
    return this.#chunks.splatLinks;
  }

  /** All but the planes of splats, which are the cloud's. */
  get bytes(): number {
    return this.#memory.report().totalBytes - this.#chunks.planes.bytes;
  }

  /** Most splats and blobs that a frame draws of what is there. */
  get capacity(): number {
    return CHUNK_SPLATS * this.chunkCells;
  }

  get freeChunks(): number {
    return this.chunkCells - this.#takenChunks;
  }

  /** Puts splats into free chunks, of which there must be enough, makes their blobs and draws them. */
  place(pieces: readonly SplatCells[]): PlacedSplats {
    const runs = pieces.flatMap((piece) => this.#write(piece));
    const dispatches = new Dispatches(this.#context);
    const upper = { start: this.chunkCells, page: this.blobPages.at(-1)! };
    for (const { cells, first } of runs) this.#chunks.merge(dispatches, cells, first, upper);
    if (runs.length > 0) dispatches.submit(`${this.#scene.name} leaf`);
    for (const { cells, first } of runs)
      for (const [i, cell] of cells.entries()) this.#chunks.writeHead(cell, first + i, undefined);
    this.#changed();
    return { runs, chunkCount: runs.reduce((sum, { cells }) => sum + cells.length, 0) };
  }

  /** Draws splats that have been placed, or does not, though they stay. */
  show({ runs }: PlacedSplats, isShown: boolean): void {
    for (const { cells, first } of runs) {
      this.#chunks.show(
        cells.map((_, i) => first + i),
        isShown,
      );
      if (isShown) this.#chunks.bound(cells, first);
      else this.#chunks.unbound(first, first + cells.length);
    }
    this.#changed();
  }

  remove({ runs, chunkCount }: PlacedSplats): void {
    for (const { cells, first } of runs) {
      this.#chunks.clear(first, cells.length);
      this.#chunks.unbound(first, first + cells.length);
      this.#isTaken.fill(0, first, first + cells.length);
    }
    this.#takenChunks -= chunkCount;
    this.#changed();
  }

  childCell(): null {
    return null;
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

  /** Fills everything with nothing. */
  #clear(): void {
    const { queue } = this.#context.device;
    const nowhere = this.chunkCells;
    queue.writeBuffer(this.cells, LevelCell.bytes * nowhere, nowhereCell(nowhere));
    queue.writeBuffer(this.blobPages.at(-1)!.links, 0, emptyLinks(nowhere, UPPER_CHUNKS));
    const { pageChunks } = this.#chunks;
    for (let first = 0; first < nowhere; first += pageChunks)
      this.#chunks.clear(first, Math.min(pageChunks, nowhere - first));
    this.#chunks.unbound(0, nowhere);
  }

  #changed(): void {
    if (!this.#cloud) return;
    this.#cloud.chunks = this.#chunks.words.buffer;
    this.#cloud.version++;
  }
}
