import type { BrickCell } from '../../data/bricks/brick.ts';
import type { SplatCells } from '../../data/bricks/leaf-scene.ts';
import { CHUNK_WORDS } from '../../data/layout/chunk-words.ts';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { ChunkLinks, LEVEL_CONSTANTS, LevelCell, MergeParameters } from '../../data/layout/level-structs.ts';
import { GEOMETRY_WORDS } from '../../data/packing/geometry.ts';
import { shWordsPerSplat } from '../../data/packing/harmonics.ts';
import { BLOB_PRECISION } from '../../data/packing/precision.ts';
import type { ShDegree } from '../../data/splats/splat-set.ts';
import type { GpuMemory } from '../../gpu/gpu-memory.ts';
import type { Bindings, StageDefinition } from '../../gpu/pipelines.ts';
import { mergeChunks, mergeHarmonics } from '../../stages/merge/merge.ts';
import { type CloudPage, CloudPlanes } from '../cloud-planes.ts';
import type { DispatchContext, Dispatches } from '../ingest/dispatches.ts';
import type { BlobPage } from '../levels.ts';

const { CELL_CHILDREN } = LEVEL_CONSTANTS;
/** Precisions of the splats of streamed scenes. */
export const STREAM_PRECISION = { geometryPrecision: 'packed', shPrecision: 'u8' } as const;
const SPLAT_WORDS = GEOMETRY_WORDS[STREAM_PRECISION.geometryPrecision];
export const BLOB_WORDS = GEOMETRY_WORDS[BLOB_PRECISION.geometryPrecision];
export const LINKS_BYTES = 4 * ChunkLinks.words;
/** Word offsets of these fields in a `ChunkLinks`. */
const CELL_WORD = 0;
const CELL_ERROR_WORD = 1;
const UNCOUNTED_WORD = 7;
/** A coordinate outside of every frustum. */
export const NOWHERE = 1e18;

/** Bytes of harmonics per splat or blob. */
export function shBytes(shDegree: ShDegree): number {
  return shDegree > 0 ? 4 * shWordsPerSplat(shDegree, STREAM_PRECISION.shPrecision) : 0;
}

/** Bytes per chunk, with its cell and its blobs. */
export function chunkBytes(shDegree: ShDegree): number {
  const blobBytes = 4 * BLOB_WORDS + shBytes(shDegree);
  const planes = CHUNK_SPLATS * (4 * SPLAT_WORDS + shBytes(shDegree) + blobBytes) + 4 * CHUNK_WORDS.count;
  return planes + LevelCell.bytes + 2 * LINKS_BYTES;
}

/**
 * Stages that make blobs, by degree. Made once, because pipelines are cached by the identity of
 * their stages.
 */
const MERGE_STAGES = ([0, 1, 2, 3] as const).map((shDegree) => {
  const stages = (from: 'packed' | 'upper') => [
    mergeChunks(from),
    ...(shDegree > 0 ? [mergeHarmonics(shDegree, from === 'upper' ? from : STREAM_PRECISION)] : []),
  ];
  return { chunks: stages(STREAM_PRECISION.geometryPrecision), upper: stages('upper') };
});

/** Stages that merge blobs of chunks, and stages that merge blobs of upper levels. */
export function mergeStages(
  shDegree: ShDegree,
): Readonly<Record<'chunks' | 'upper', readonly StageDefinition[]>> {
  return MERGE_STAGES[shDegree];
}

/** The upper levels of a pool, as stages that merge chunks bind them. */
export interface UpperLevels {
  /** Index of the first cell above the chunks. */
  readonly start: number;
  readonly page: BlobPage;
}

/** A run of chunks to copy from one page to another. */
export interface ChunkMove {
  readonly from: number;
  readonly to: number;
  readonly count: number;
}

/**
 * GPU memory for chunks of splats and their blobs, in pages: the lowest level of a pool. Chunk `i`
 * is cell `i` of the pool. A run of chunks never crosses a page.
 */
export class ChunkPages {
  readonly planes: CloudPlanes;
  readonly splatLinks: readonly GPUBuffer[];
  readonly blobPages: readonly BlobPage[];
  /** Row in the file per splat slot. */
  readonly rows: Uint32Array<ArrayBuffer>;
  /** Chunks per page, a multiple of 16; the last page may have fewer. */
  readonly pageChunks: number;
  readonly #device: GPUDevice;
  readonly #memory: GpuMemory;
  readonly #dispatchRow: number;
  readonly #shDegree: ShDegree;
  readonly #cells: GPUBuffer;
  /** Index of the cell of empty chunks. */
  readonly #nowhere: number;
  #words: Float32Array<ArrayBuffer>;
  #isGivenAway = false;

  /**
   * @param cells the buffer of the pool's cells.
   * @param nowhere index of the cell of empty chunks, which is never in sight.
   * @param before the pages that these replace, without blobs, and the chunks to copy. The caller
   *   then calls `keep` for each chunk and merges its blobs again.
   */
  constructor(
    { device, memory, dispatchRow }: DispatchContext,
    { name, shDegree }: { readonly name: string; readonly shDegree: ShDegree },
    chunkCount: number,
    cells: GPUBuffer,
    nowhere: number,
    before?: { readonly pages: ChunkPages; readonly moves: readonly ChunkMove[] },
  ) {
    const { limits } = device;
    this.#device = device;
    this.#memory = memory;
    this.#dispatchRow = dispatchRow;
    this.#shDegree = shDegree;
    this.#cells = cells;
    this.#nowhere = nowhere;
    const bindingBytes = Math.min(limits.maxStorageBufferBindingSize, limits.maxBufferSize);
    const widest = CELL_CHILDREN * CHUNK_SPLATS * Math.max(4 * BLOB_WORDS, shBytes(shDegree));
    this.pageChunks = CELL_CHILDREN * Math.floor(bindingBytes / widest);
    const ranges = Array.from({ length: Math.ceil(chunkCount / this.pageChunks) }, (_, page) => ({
      start: CHUNK_SPLATS * this.pageChunks * page,
      end: CHUNK_SPLATS * Math.min(chunkCount, this.pageChunks * (page + 1)),
    }));
    const plane = (what: string, bytesPerSplat: number) =>
      ranges.map(({ start, end }, page) =>
        poolBuffer(memory, `${name} ${what} ${page}`, bytesPerSplat * (end - start)),
      );
    const chunkPlane = (what: string, bytesPerChunk: number) => plane(what, bytesPerChunk / CHUNK_SPLATS);
    this.planes = new CloudPlanes(memory, name, {
      ...STREAM_PRECISION,
      shDegree,
      ranges,
      chunks: chunkPlane('chunks', 4 * CHUNK_WORDS.count),
      geometry: plane('geometry', 4 * SPLAT_WORDS),
      harmonics: shDegree > 0 ? plane('spherical harmonics', shBytes(shDegree)) : [],
    });
    if (before) this.#takeOver(before.pages, before.moves);
    this.splatLinks = chunkPlane('splat links', LINKS_BYTES);
    this.blobPages = ranges.map(({ start, end }, page) =>
      makeBlobPage(memory, `${name} blob ${page}`, shDegree, cells, end - start),
    );
    this.rows = new Uint32Array(CHUNK_SPLATS * chunkCount);
    this.#words = new Float32Array(CHUNK_WORDS.count * chunkCount);
    for (let first = 0; first < chunkCount; first += CELL_CHILDREN)
      this.clear(first, Math.min(CELL_CHILDREN, chunkCount - first));
  }

  /**
   * Words of the `Chunk` structs of all splats. The returned array never changes; later changes go
   * to a copy.
   */
  get words(): Float32Array<ArrayBuffer> {
    this.#isGivenAway = true;
    return this.#words;
  }

  /**
   * Writes cells with their splats to the chunks from `first` on. They are drawn once their blobs
   * are merged.
   *
   * @param cellErrors the errors at which cells end, if known.
   */
  write(
    { cells, geometry, harmonics, rows }: SplatCells,
    first: number,
    cellErrors: readonly number[] = [],
  ): void {
    const { queue } = this.#device;
    const { page, chunk } = this.#placeOf(first);
    const { geometry: splats, shRest } = this.planes.pagesFor(STREAM_PRECISION).pages[page];
    queue.writeBuffer(splats, 4 * SPLAT_WORDS * CHUNK_SPLATS * chunk, geometry);
    if (shRest) queue.writeBuffer(shRest, shBytes(this.#shDegree) * CHUNK_SPLATS * chunk, harmonics);
    this.keep({ cells, rows }, first, cellErrors);
  }

  /** Like `write`, for splats that the chunks hold already. */
  keep(
    { cells, rows }: Pick<SplatCells, 'cells' | 'rows'>,
    first: number,
    cellErrors: readonly number[] = [],
  ): void {
    const { queue } = this.#device;
    const { page, chunk } = this.#placeOf(first);
    const { chunks } = this.planes.pagesFor(STREAM_PRECISION).pages[page];
    this.bound(cells, first);
    const start = CHUNK_WORDS.count * first;
    const words = CHUNK_WORDS.count * cells.length;
    queue.writeBuffer(chunks, 4 * CHUNK_WORDS.count * chunk, this.#words, start, words);
    this.rows.set(rows, CHUNK_SPLATS * first);
    const links = emptyLinks(this.#nowhere, cells.length, cellErrors);
    queue.writeBuffer(this.blobPages[page].links, LINKS_BYTES * chunk, links);
    for (const [i, { leafCount }] of cells.entries())
      links[ChunkLinks.words * i + UNCOUNTED_WORD] = CHUNK_SPLATS - leafCount;
    queue.writeBuffer(this.splatLinks[page], LINKS_BYTES * chunk, links);
  }

  /** Adds dispatches that merge the blobs of chunks. All chunks are full but the last. */
  merge(dispatches: Dispatches, cells: readonly BrickCell[], first: number, upper: UpperLevels): void {
    const { page, chunk } = this.#placeOf(first);
    const { geometry, shRest, chunks } = this.planes.pagesFor(STREAM_PRECISION).pages[page];
    const blobs = this.blobPages[page];
    const bindings: Bindings = {
      ...upperBindings(this.#cells, upper.page),
      splats: geometry,
      chunks,
      splatLinks: this.splatLinks[page],
      blobs: blobs.geometry,
      blobLinks: blobs.links,
      ...(shRest && { shRest, blobSh: blobs.shRest! }),
    };
    const parameters = MergeParameters.pack({
      firstCell: first,
      endCell: first + cells.length,
      pageStart: this.pageChunks * page,
      levelStart: 0,
      nextLevelStart: 0,
      upperStart: upper.start,
      splatCount: CHUNK_SPLATS * (chunk + cells.length - 1) + cells.at(-1)!.leafCount,
      hasNextLevel: 0,
      dispatchRow: this.#dispatchRow,
    });
    for (const stage of mergeStages(this.#shDegree).chunks)
      dispatches.add(stage, parameters, bindings, cells.length);
  }

  /** Frees all buffers except the planes of splats, before other pages replace these. */
  freeBlobs(): void {
    for (const page of this.blobPages) freeBlobPage(this.#memory, page);
    for (const links of this.splatLinks) this.#memory.destroy(links);
  }

  /** Marks chunks of one page as empty. */
  clear(first: number, count: number): void {
    this.unbound(first, count);
    const { page, chunk } = this.#placeOf(first);
    const noLinks = emptyLinks(this.#nowhere, count);
    for (const links of [this.splatLinks[page], this.blobPages[page].links])
      this.#device.queue.writeBuffer(links, LINKS_BYTES * chunk, noLinks);
  }

  /** Sets the bounds of chunks on the CPU, for counts of splats in sight. */
  bound(cells: readonly BrickCell[], first: number): void {
    const words = this.#ownWords();
    for (const [i, { bounds, logScales }] of cells.entries()) {
      const at = CHUNK_WORDS.count * (first + i);
      words.set(bounds.min, at + CHUNK_WORDS.minPosition);
      words.set(bounds.max, at + CHUNK_WORDS.maxPosition);
      words[at + CHUNK_WORDS.minLogScale] = logScales[0];
      words[at + CHUNK_WORDS.logScaleStep] = logScales[1];
    }
  }

  /** Sets bounds of chunks on the CPU that are never in sight. */
  unbound(first: number, count: number): void {
    const words = this.#ownWords();
    for (let chunk = first; chunk < first + count; chunk++) {
      const at = CHUNK_WORDS.count * chunk;
      words.fill(NOWHERE, at + CHUNK_WORDS.minPosition, at + CHUNK_WORDS.minPosition + 3);
      words.fill(-NOWHERE, at + CHUNK_WORDS.maxPosition, at + CHUNK_WORDS.maxPosition + 3);
    }
  }

  /** Copies splats of other pages, then frees their planes. */
  #takeOver(before: ChunkPages, moves: readonly ChunkMove[]): void {
    const encoder = this.#device.createCommandEncoder({ label: 'pool' });
    const [own, others] = [this, before].map(({ planes }) => planes.pagesFor(STREAM_PRECISION).pages);
    for (const { from, to, count } of moves) {
      const [source, target] = [before.#placeOf(from), this.#placeOf(to)];
      const move = { from: source.chunk, to: target.chunk, count };
      copyChunks(encoder, others[source.page], own[target.page], move, SPLAT_WORDS, this.#shDegree);
    }
    this.#device.queue.submit([encoder.finish()]);
    before.planes.destroy();
  }

  #ownWords(): Float32Array<ArrayBuffer> {
    if (this.#isGivenAway) this.#words = this.#words.slice();
    this.#isGivenAway = false;
    return this.#words;
  }

  /** The page of a chunk, and its index within the page. */
  #placeOf(chunk: number): { readonly page: number; readonly chunk: number } {
    const page = Math.floor(chunk / this.pageChunks);
    return { page, chunk: chunk - this.pageChunks * page };
  }
}

/** Copies geometry and harmonics of chunks. */
export function copyChunks(
  encoder: GPUCommandEncoder,
  source: CloudPage,
  target: CloudPage,
  { from, to, count }: ChunkMove,
  geometryWords: number,
  shDegree: ShDegree,
): void {
  const copy = (plane: 'geometry' | 'shRest', bytesPerSplat: number) => {
    const [read, written] = [source[plane], target[plane]];
    const bytes = CHUNK_SPLATS * bytesPerSplat;
    if (read && written) encoder.copyBufferToBuffer(read, bytes * from, written, bytes * to, bytes * count);
  };
  copy('geometry', 4 * geometryWords);
  copy('shRest', shBytes(shDegree));
}

/** A buffer of a pool, writable whenever parts of a scene arrive. */
export function poolBuffer(memory: GpuMemory, label: string, bytes: number): GPUBuffer {
  const { STORAGE, COPY_SRC, COPY_DST } = GPUBufferUsage;
  return memory.createBuffer(label, bytes, STORAGE | COPY_SRC | COPY_DST);
}

/** Allocates buffers for blobs and their links. */
export function makeBlobPage(
  memory: GpuMemory,
  what: string,
  shDegree: ShDegree,
  cells: GPUBuffer,
  splatCount: number,
): BlobPage {
  const buffer = (part: string, bytes: number) => poolBuffer(memory, `${what} ${part}`, bytes);
  return {
    splatCount,
    chunkCount: splatCount / CHUNK_SPLATS,
    geometry: buffer('geometry', 4 * BLOB_WORDS * splatCount),
    shRest: shDegree > 0 ? buffer('spherical harmonics', shBytes(shDegree) * splatCount) : null,
    chunks: cells,
    links: buffer('links', (LINKS_BYTES * splatCount) / CHUNK_SPLATS),
  };
}

export function freeBlobPage(memory: GpuMemory, { geometry, shRest, links }: BlobPage): void {
  for (const buffer of [geometry, shRest, links]) if (buffer) memory.destroy(buffer);
}

export function upperBindings(cells: GPUBuffer, { geometry, links, shRest }: BlobPage): Bindings {
  return { cells, upper: geometry, upperLinks: links, ...(shRest && { upperSh: shRest }) };
}

/**
 * Links of empty chunks.
 *
 * @param cellErrors errors at which the cells to be merged there end, if known; merging keeps them.
 */
export function emptyLinks(
  nowhere: number,
  chunkCount: number,
  cellErrors: readonly number[] = [],
): Uint32Array<ArrayBuffer> {
  const links = new Uint32Array(chunkCount * ChunkLinks.words);
  for (let chunk = 0; chunk < chunkCount; chunk++) {
    links[chunk * ChunkLinks.words + CELL_WORD] = nowhere;
    links[chunk * ChunkLinks.words + CELL_ERROR_WORD] = cellErrors[chunk] ?? 0;
  }
  return links;
}
