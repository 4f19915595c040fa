import type { BrickCell, BrickScene } from '../../data/bricks/brick.ts';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { LEVEL_CONSTANTS, LevelCell } from '../../data/layout/level-structs.ts';
import type { StageDefinition } from '../../gpu/pipelines.ts';
import type { DispatchContext, Dispatches } from '../ingest/dispatches.ts';
import type { BlobPage, Levels } from '../levels/levels.ts';
import { type CloudPool, SplatCloud, type SplatCloudOptions } from '../splat-cloud.ts';
import {
  BLOB_WORDS,
  type ChunkMove,
  ChunkPages,
  chunkBytes,
  copyChunks,
  emptyLinks,
  freeBlobPage,
  LINKS_BYTES,
  makeBlobPage,
  NOWHERE,
  poolBuffer,
  STREAM_PRECISION,
} from './chunk-pages.ts';
import { type MissingPart, type SceneParts, SceneStream } from './scene-stream.ts';
import { type StreamContext, type StreamNeed, type StreamOptions, withShare } from './stream-budget.ts';

const { CELL_CHILDREN } = LEVEL_CONSTANTS;
/** Its bounds are outside of every frustum. */
const HIDDEN_CELL: Pick<BrickCell, 'bounds'> = {
  bounds: { min: [NOWHERE, NOWHERE, NOWHERE], max: [-NOWHERE, -NOWHERE, -NOWHERE] },
};
/** Advice in the error if the device lacks memory for a pool. */
const POOL_ADVICE = 'Give it fewer bytes.';

/** Properties of a streamed scene that its cloud exposes. */
export type StreamedScene = Pick<
  BrickScene,
  'name' | 'splatCount' | 'shDegree' | 'isAntialiased' | 'origin' | 'bounds' | 'robustBounds'
>;

/** Sizes of a pool. */
export interface PoolShape {
  /** Most chunks of splats; each has a cell. */
  readonly chunkCells: number;
  /** Chunks for which there is memory at first. Default: all. */
  readonly firstChunks?: number;
  /** Cells above the chunks; each has a chunk of leaves and one of blobs in the upper page. */
  readonly upperCells: number;
}

/** A pool to be replaced, and the chunks to copy from it. */
export interface ReplacedPool {
  readonly pool: ScenePool;
  /** Runs of chunks within one page of that pool and one page of the new. */
  readonly moves: readonly ChunkMove[];
  /** Chunks of the upper page. */
  readonly upperMoves: readonly ChunkMove[];
}

/**
 * Makes a pool with its own share of GPU memory.
 *
 * @param stages stages needed to place its first parts.
 * @throws GpuLimitError if the device lacks the memory; nothing is left allocated then.
 */
export async function makePool<Pool>(
  context: DispatchContext,
  { name }: StreamedScene,
  stages: readonly StageDefinition[],
  make: (context: DispatchContext) => Pool,
): Promise<Pool> {
  const memory = context.memory.part();
  await context.pipelines.prepare(stages);
  const { result: pool, checked } = memory.guard(name, POOL_ADVICE, () => {
    try {
      return make({ ...context, memory });
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

/**
 * GPU memory for parts of one scene, drawn by its cloud, whose levels it is. `BrickPool` and
 * `LeafPool` decide which chunks and cells a part takes.
 */
export abstract class ScenePool implements Levels, CloudPool {
  readonly cellCount: number;
  readonly chunkCells: number;
  readonly cells: GPUBuffer;
  readonly refinement = null;
  /** With the memory of the pool alone. */
  protected readonly context: DispatchContext;
  protected readonly scene: StreamedScene;
  protected readonly pages: ChunkPages;
  /** The leaves and blobs of the cells above the chunks. */
  protected readonly upperPage: BlobPage;
  #blobPages: readonly BlobPage[];
  #cloud: SplatCloud | null = null;

  /** @param before a pool whose buffers are freed; subclasses then take over its parts. */
  protected constructor(
    context: DispatchContext,
    scene: StreamedScene,
    { chunkCells, firstChunks = chunkCells, upperCells }: PoolShape,
    before?: ReplacedPool,
  ) {
    const { memory } = context;
    const { name, shDegree } = scene;
    this.context = context;
    this.scene = scene;
    this.chunkCells = chunkCells;
    // The last cell belongs to empty chunks: never in sight and never drawn.
    this.cellCount = chunkCells + upperCells + 1;
    this.cells = poolBuffer(memory, `${name} cells`, LevelCell.bytes * this.cellCount);
    // Blobs, more than half of a pool, are freed first and merged again, so that two pools fit in
    // memory.
    if (before) before.pool.pages.freeBlobs();
    // Buffers must not be empty.
    const upperChunks = 2 * Math.max(1, upperCells);
    const upperSplats = CHUNK_SPLATS * upperChunks;
    this.upperPage = makeBlobPage(memory, `${name} upper blob`, shDegree, this.cells, upperSplats);
    if (before) this.#takeUpper(before, this.upperPage);
    this.pages = new ChunkPages(
      context,
      { scene, cells: this.cells, nowhere: this.nowhere },
      firstChunks,
      before && { pages: before.pool.pages, moves: before.moves },
    );
    this.#blobPages = [...this.pages.blobPages, this.upperPage];
    this.hideCells(this.nowhere, 1);
    for (let chunk = 0; chunk < upperChunks; chunk += 2 * CELL_CHILDREN)
      this.writeUpperLinks(chunk, emptyLinks(this.nowhere, Math.min(2 * CELL_CHILDREN, upperChunks - chunk)));
  }

  abstract levelOf(cell: number): number;
  abstract childCell(cell: number, slot: number): number | null;

  /** Copies leaves of another pool's upper page, then frees that page and the cells. */
  #takeUpper({ pool, upperMoves }: ReplacedPool, page: BlobPage): void {
    const { device, memory } = this.context;
    const encoder = device.createCommandEncoder({ label: 'pool' });
    for (const move of upperMoves)
      copyChunks(encoder, pool.upperPage, page, move, BLOB_WORDS, this.scene.shDegree);
    device.queue.submit([encoder.finish()]);
    freeBlobPage(memory, pool.upperPage);
    memory.destroy(pool.cells);
  }

  /**
   * Makes a pool of another size with all parts of this one, which replaces this one in its cloud.
   * Both together never take more memory than the larger one. Splats and leaves are copied on the
   * GPU; their blobs are merged again. If the device lacks the memory, the cloud is destroyed.
   *
   * @returns null if the engine's memory budget has no room for it; nothing is made then.
   */
  protected replaced<Pool extends ScenePool>(growthBytes: number, make: () => Pool): Pool | null {
    const { memory } = this.context;
    if (growthBytes > memory.availableBytes) return null;
    const { result: pool, checked } = memory.guard(this.scene.name, POOL_ADVICE, make);
    const cloud = this.#cloud!;
    pool.#cloud = cloud;
    cloud.takePool(pool, { planes: pool.pages.planes, fileIndices: pool.pages.fileIndices }, checked);
    return pool;
  }

  /**
   * Adds memory for further chunks. If the device lacks it, the cloud is destroyed.
   *
   * @returns false if the engine's memory budget has no room for it; nothing is made then.
   */
  protected grow(chunkCount: number): boolean {
    const { memory } = this.context;
    const { name, shDegree } = this.scene;
    if (chunkCount * chunkBytes(shDegree) > memory.availableBytes) return false;
    const { checked } = memory.guard(name, POOL_ADVICE, () => this.pages.add(chunkCount));
    const { planes, fileIndices } = this.pages;
    this.#blobPages = [...this.pages.blobPages, this.upperPage];
    this.#cloud?.takePool(this, { planes, fileIndices }, checked);
    return true;
  }

  /** Makes the cloud that draws this pool. */
  cloud(options: Pick<SplatCloudOptions, 'stream' | 'onDestroyed'> = {}): SplatCloud {
    const { name, splatCount, shDegree, isAntialiased, origin, bounds, robustBounds } = this.scene;
    const facts = {
      declaredShDegree: shDegree,
      trueShDegree: shDegree,
      // Unknown until the whole scene is resident: assume that every band matters.
      shBandReach: Array.from({ length: shDegree }, () => Number.POSITIVE_INFINITY),
      paletteEntries: null,
      isIsotropic: false,
      isAntialiased: isAntialiased ?? null,
      fileFacts: null,
    };
    const contents = {
      count: splatCount,
      origin,
      bounds,
      robustBounds,
      dropped: {},
      fileIndices: this.pages.fileIndices,
      facts,
      chunks: this.chunks,
      precision: STREAM_PRECISION,
    };
    const { device } = this.context;
    this.#cloud = new SplatCloud(device, this.pages.planes, contents, { ...options, name, pool: this });
    return this.#cloud;
  }

  /** Call after the parts have changed. */
  protected onChanged(): void {
    this.#cloud?.markChanged();
  }

  get splatLinks(): readonly GPUBuffer[] {
    return this.pages.splatLinks;
  }

  get blobPages(): readonly BlobPage[] {
    return this.#blobPages;
  }

  /** Bytes of the pool without the planes of splats, which the cloud counts. */
  get bytes(): number {
    return this.context.memory.report().totalBytes - this.pages.planes.bytes;
  }

  /** Most splats and blobs that one frame can draw from this pool. */
  get capacity(): number {
    return CHUNK_SPLATS * (this.nowhere - this.chunkCells + this.pages.chunkCount);
  }

  get chunks(): ArrayBuffer {
    return this.pages.words.buffer;
  }

  /** Index of the cell of empty chunks. */
  protected get nowhere(): number {
    return this.cellCount - 1;
  }

  /** Adds dispatches that merge the blobs of chunks of one page. */
  protected mergeChunks(dispatches: Dispatches, first: number, chunkCount: number): void {
    this.pages.merge(dispatches, first, chunkCount, { start: this.chunkCells, page: this.upperPage });
  }

  /** @param parentOf returns the index of the cell above. */
  protected writeCells<Cell extends Pick<BrickCell, 'bounds'>>(
    cells: readonly Cell[],
    first: number,
    parentOf: (cell: Cell) => number,
  ): void {
    const contents = new ArrayBuffer(LevelCell.bytes * cells.length);
    for (const [i, cell] of cells.entries()) {
      const { min, max } = cell.bounds;
      const values = { minPosition: min, maxPosition: max, parent: parentOf(cell) };
      LevelCell.write(contents, values, LevelCell.bytes * i);
    }
    this.context.device.queue.writeBuffer(this.cells, LevelCell.bytes * first, contents);
  }

  /** Moves cells out of every frustum. */
  protected hideCells(first: number, count: number): void {
    this.writeCells(
      Array.from({ length: count }, () => HIDDEN_CELL),
      first,
      () => this.nowhere,
    );
  }

  /** @param chunk index of the first chunk in the upper page. */
  protected writeUpperLinks(chunk: number, links: Uint32Array<ArrayBuffer>): void {
    this.context.device.queue.writeBuffer(this.upperPage.links, LINKS_BYTES * chunk, links);
  }

  /** Resolves when the GPU has finished all submitted work. */
  whenDone(): Promise<unknown> {
    return this.context.device.queue.onSubmittedWorkDone();
  }

  destroy(): void {
    this.context.memory.destroyAll();
  }
}

/** Chunks from which on placed ones are written, so that the caller sees the time that it takes. */
export const WRITTEN_AT_ONCE = 64;

/** Chunks of one page. */
export interface Chunks {
  readonly first: number;
  readonly count: number;
  /** The chunk after the last one of the page. */
  readonly pageEnd: number;
}

export interface JoinedChunks<Part> {
  readonly first: number;
  count: number;
  readonly parts: Part[];
}

/** Sorts ranges of chunks, and joins those that adjoin in the same page. */
export function joined<Part extends Chunks>(parts: readonly Part[]): readonly JoinedChunks<Part>[] {
  const all: JoinedChunks<Part>[] = [];
  for (const part of parts.toSorted((a, b) => a.first - b.first)) {
    const last = all.at(-1);
    if (last && last.first + last.count === part.first && part.first < last.parts[0].pageEnd) {
      last.count += part.count;
      last.parts.push(part);
    } else all.push({ first: part.first, count: part.count, parts: [part] });
  }
  return all;
}

/**
 * Makes a cloud with the pool of a scene, and the stream that fills it. Leaves nothing allocated on
 * failure.
 *
 * @param makePool makes a pool of this many bytes.
 * @param begin places the first parts in the pool, of a share of this many bytes.
 * @throws the signal's reason; errors of `withShare`, `makePool` and `begin`.
 */
export function streamInto<Pool extends ScenePool, Part extends MissingPart>(
  { shares }: StreamContext,
  need: StreamNeed,
  options: StreamOptions & Pick<SplatCloudOptions, 'onDestroyed'>,
  makePool: (bytes: number) => Promise<Pool>,
  begin: (pool: Pool, bytes: number) => SceneParts<Part>,
): Promise<SplatCloud> {
  return withShare(shares, need, options, async (shareBytes, leave) => {
    const pool = await makePool(shareBytes);
    try {
      options.signal?.throwIfAborted();
      const stream = new SceneStream(begin(pool, shareBytes));
      const made = pool.cloud({
        stream,
        onDestroyed: (cloud) => {
          leave();
          options.onDestroyed?.(cloud);
        },
      });
      return { made, resize: (bytes) => stream.resize(bytes) };
    } catch (error) {
      pool.destroy();
      throw error;
    }
  });
}
