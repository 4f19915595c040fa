import type { BrickCell } from '../../data/bricks/brick.ts';
import type { SplatCells } from '../../data/bricks/leaf-scene.ts';
import { CHUNK_WORDS } from '../../data/layout/chunk-words.ts';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { ChunkLinks, LEVEL_CONSTANTS, LevelCell, MergeParameters } from '../../data/layout/level-structs.ts';
import { setLogScales } from '../../data/packing/chunks.ts';
import { GEOMETRY_WORDS } from '../../data/packing/geometry.ts';
import { shWordsPerSplat } from '../../data/packing/harmonics.ts';
import { BLOB_PRECISION } from '../../data/packing/precision.ts';
import type { ShDegree } from '../../data/splats/splat-set.ts';
import type { GpuMemory } from '../../gpu/gpu-memory.ts';
import type { Bindings, StageDefinition } from '../../gpu/pipelines.ts';
import { mergeChunks, mergeHarmonics } from '../../stages/merge/merge.ts';
import { type CloudPage, CloudPlanes, type PageRange } from '../cloud-planes.ts';
import type { DispatchContext, Dispatches } from '../ingest/dispatches.ts';
import type { BlobPage } from '../levels/levels.ts';

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
/** Chunks whose links are marked as empty by one copy. */
const CLEARED_AT_ONCE = 256;
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

/** Stages that streamed scenes of any degree need. */
export const FIRST_STAGES = mergeStages(0).chunks;

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

/** The scene and the cells of a pool of pages. */
interface PagesOf {
  readonly scene: { readonly name: string; readonly shDegree: ShDegree };
  /** The buffer of the pool's cells. */
  readonly cells: GPUBuffer;
  /** Index of the cell of empty chunks, which is never in sight. */
  readonly nowhere: number;
}

/**
 * GPU memory for chunks of splats and their blobs, in pages: the lowest level of a pool. Chunk `i`
 * is cell `i` of the pool. A run of chunks never crosses a page.
 */
export class ChunkPages {
  readonly #context: DispatchContext;
  readonly #of: PagesOf;
  /** Most chunks of a page, a multiple of 16; all pages of the constructor but the last have as many. */
  readonly mostPageChunks: number;
  /** First chunk of each page, ascending. */
  #starts: readonly number[] = [];
  #chunkCount = 0;
  #planes: CloudPlanes;
  #splatLinks: readonly GPUBuffer[] = [];
  #blobPages: readonly BlobPage[] = [];
  #fileIndices = new Uint32Array(0);
  #words = new Float32Array(0);
  #isGivenAway = false;

  /**
   * @param before the pages that these replace, without blobs, and the chunks to copy. The caller
   *   then calls `keepFileIndices` and `writeCells` for each, and merges its blobs again.
   */
  constructor(
    context: DispatchContext,
    of: PagesOf,
    chunkCount: number,
    before?: { readonly pages: ChunkPages; readonly moves: readonly ChunkMove[] },
  ) {
    const { limits } = context.device;
    this.#context = context;
    this.#of = of;
    const bindingBytes = Math.min(limits.maxStorageBufferBindingSize, limits.maxBufferSize);
    const widest = CELL_CHILDREN * CHUNK_SPLATS * Math.max(4 * BLOB_WORDS, shBytes(of.scene.shDegree));
    this.mostPageChunks = CELL_CHILDREN * Math.floor(bindingBytes / widest);
    const ranges = this.#addRanges(chunkCount);
    this.#planes = this.#planesWith(ranges);
    if (before) this.#takeOver(before.pages, before.moves);
    this.#addLinks(ranges);
  }

  /** Adds empty chunks, in pages of their own: `planes`, `fileIndices` and others are new objects then. */
  add(chunkCount: number): void {
    const ranges = this.#addRanges(chunkCount);
    this.#planes = this.#planesWith(ranges, this.#planes);
    this.#addLinks(ranges);
  }

  get planes(): CloudPlanes {
    return this.#planes;
  }

  get splatLinks(): readonly GPUBuffer[] {
    return this.#splatLinks;
  }

  get blobPages(): readonly BlobPage[] {
    return this.#blobPages;
  }

  /** Row in the file per splat slot. */
  get fileIndices(): Uint32Array<ArrayBuffer> {
    return this.#fileIndices;
  }

  get chunkCount(): number {
    return this.#chunkCount;
  }

  /** The chunk after the last one of the page that has this chunk. */
  pageEnd(chunk: number): number {
    return this.#starts[this.#placeOf(chunk).page + 1] ?? this.#chunkCount;
  }

  /** Splats of further pages, as large as bindings can be. */
  #addRanges(chunkCount: number): PageRange[] {
    const ranges: PageRange[] = [];
    const end = this.#chunkCount + chunkCount;
    for (let start = this.#chunkCount; start < end; start += this.mostPageChunks) {
      this.#starts = [...this.#starts, start];
      const pageEnd = Math.min(end, start + this.mostPageChunks);
      ranges.push({ start: CHUNK_SPLATS * start, end: CHUNK_SPLATS * pageEnd });
    }
    this.#chunkCount = end;
    return ranges;
  }

  /** Creates buffers for `ranges`; the planes have those of `before`, followed by the new ones. */
  #planesWith(ranges: readonly PageRange[], before?: CloudPlanes): CloudPlanes {
    const { memory } = this.#context;
    const { name, shDegree } = this.#of.scene;
    const plane = (what: string, bytesPerSplat: number, buffersBefore: readonly GPUBuffer[] = []) => [
      ...buffersBefore,
      ...ranges.map(({ start, end }) =>
        poolBuffer(memory, `${name} ${what} from ${start}`, bytesPerSplat * (end - start)),
      ),
    ];
    const { geometryPrecision, shPrecision } = STREAM_PRECISION;
    return new CloudPlanes(memory, name, {
      ...STREAM_PRECISION,
      shDegree,
      ranges: [...(before?.ranges ?? []), ...ranges],
      chunks: plane('chunks', (4 * CHUNK_WORDS.count) / CHUNK_SPLATS, before?.chunksPlane),
      geometry: plane('geometry', 4 * SPLAT_WORDS, before?.geometryPlane(geometryPrecision)),
      harmonics:
        shDegree > 0 ? plane('spherical harmonics', shBytes(shDegree), before?.shPlane(shPrecision)) : [],
    });
  }

  /** Makes links and blobs of further ranges, all empty. */
  #addLinks(ranges: readonly PageRange[]): void {
    const { memory } = this.#context;
    const { scene, cells } = this.#of;
    const { name, shDegree } = scene;
    for (const { start, end } of ranges) {
      const links = poolBuffer(
        memory,
        `${name} splat links from ${start}`,
        (LINKS_BYTES * (end - start)) / CHUNK_SPLATS,
      );
      const blobs = makeBlobPage(memory, `${name} blobs from ${start}`, shDegree, cells, end - start);
      this.#splatLinks = [...this.#splatLinks, links];
      this.#blobPages = [...this.#blobPages, blobs];
    }
    const [fileIndices, words] = [this.#fileIndices, this.#words];
    this.#fileIndices = new Uint32Array(CHUNK_SPLATS * this.#chunkCount);
    this.#fileIndices.set(fileIndices);
    this.#words = new Float32Array(CHUNK_WORDS.count * this.#chunkCount);
    this.#words.set(words);
    this.#isGivenAway = false;
    this.#clearAll(ranges);
  }

  /** Marks all chunks of new pages as empty, by copies of a few: their links would take long to upload. */
  #clearAll(ranges: readonly PageRange[]): void {
    const { device, memory } = this.#context;
    const encoder = device.createCommandEncoder({ label: 'pool' });
    const few = emptyLinks(this.#of.nowhere, CLEARED_AT_ONCE);
    const empty = memory.createFilledBuffer('empty links', few);
    for (const { start, end } of ranges) {
      const [first, last] = [start / CHUNK_SPLATS, end / CHUNK_SPLATS];
      this.unbound(first, last - first);
      const { page } = this.#placeOf(first);
      for (let from = 0; from < last - first; from += CLEARED_AT_ONCE) {
        const bytes = LINKS_BYTES * Math.min(CLEARED_AT_ONCE, last - first - from);
        for (const links of [this.#splatLinks[page], this.#blobPages[page].links])
          encoder.copyBufferToBuffer(empty, 0, links, LINKS_BYTES * from, bytes);
      }
    }
    device.queue.submit([encoder.finish()]);
    memory.destroy(empty);
  }

  /**
   * Words of the `Chunk` structs of all splats. The returned array never changes; later changes go
   * to a copy.
   */
  get words(): Float32Array<ArrayBuffer> {
    this.#isGivenAway = true;
    return this.#words;
  }

  /** Writes splats to the chunks from `first` on, of one page. `writeCells` must follow. */
  writeSplats({ geometry, harmonics, fileIndices }: Omit<SplatCells, 'cells'>, first: number): void {
    const { queue } = this.#context.device;
    const { page, chunk } = this.#placeOf(first);
    const { geometry: splats, shRest } = this.#planes.pagesFor(STREAM_PRECISION).pages[page];
    queue.writeBuffer(splats, 4 * SPLAT_WORDS * CHUNK_SPLATS * chunk, geometry);
    if (shRest) queue.writeBuffer(shRest, shBytes(this.#of.scene.shDegree) * CHUNK_SPLATS * chunk, harmonics);
    this.keepFileIndices(fileIndices, first);
  }

  /** Sets the file indices of splats from the chunk `first` on. */
  keepFileIndices(fileIndices: Uint32Array<ArrayBuffer>, first: number): void {
    this.#fileIndices.set(fileIndices, CHUNK_SPLATS * first);
  }

  /**
   * Writes the cells of splats that chunks of one page hold, from `first` on. They are drawn once
   * their blobs are merged.
   *
   * @param cellErrors the errors at which cells end, if known.
   */
  writeCells(cells: readonly BrickCell[], first: number, cellErrors: readonly number[] = []): void {
    const { queue } = this.#context.device;
    const { page, chunk } = this.#placeOf(first);
    const { chunks } = this.#planes.pagesFor(STREAM_PRECISION).pages[page];
    this.bound(cells, first);
    const start = CHUNK_WORDS.count * first;
    const words = CHUNK_WORDS.count * cells.length;
    queue.writeBuffer(chunks, 4 * CHUNK_WORDS.count * chunk, this.#words, start, words);
    const links = emptyLinks(this.#of.nowhere, cells.length, cellErrors);
    queue.writeBuffer(this.#blobPages[page].links, LINKS_BYTES * chunk, links);
    for (const [i, { leafCount }] of cells.entries())
      links[ChunkLinks.words * i + UNCOUNTED_WORD] = CHUNK_SPLATS - leafCount;
    queue.writeBuffer(this.#splatLinks[page], LINKS_BYTES * chunk, links);
  }

  /** Adds dispatches that merge the blobs of chunks of one page. */
  merge(dispatches: Dispatches, first: number, chunkCount: number, upper: UpperLevels): void {
    const { page, chunk } = this.#placeOf(first);
    const { geometry, shRest, chunks } = this.#planes.pagesFor(STREAM_PRECISION).pages[page];
    const blobs = this.#blobPages[page];
    const bindings: Bindings = {
      ...upperBindings(this.#of.cells, upper.page),
      splats: geometry,
      chunks,
      splatLinks: this.#splatLinks[page],
      blobs: blobs.geometry,
      blobLinks: blobs.links,
      ...(shRest && { shRest, blobSh: blobs.shRest! }),
    };
    const parameters = MergeParameters.pack({
      firstCell: first,
      endCell: first + chunkCount,
      pageStart: this.#starts[page],
      levelStart: 0,
      nextLevelStart: 0,
      upperStart: upper.start,
      splatCount: CHUNK_SPLATS * (chunk + chunkCount),
      hasNextLevel: 0,
      dispatchRow: this.#context.dispatchRow,
    });
    for (const stage of mergeStages(this.#of.scene.shDegree).chunks)
      dispatches.add(stage, parameters, bindings, chunkCount);
  }

  /** Frees all buffers except the planes of splats, before other pages replace these. */
  freeBlobs(): void {
    for (const page of this.blobPages) freeBlobPage(this.#context.memory, page);
    for (const links of this.splatLinks) this.#context.memory.destroy(links);
  }

  /** Marks chunks of one page as empty. */
  clear(first: number, count: number): void {
    this.unbound(first, count);
    const { page, chunk } = this.#placeOf(first);
    const noLinks = emptyLinks(this.#of.nowhere, count);
    for (const links of [this.#splatLinks[page], this.#blobPages[page].links])
      this.#context.device.queue.writeBuffer(links, LINKS_BYTES * chunk, noLinks);
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
    const encoder = this.#context.device.createCommandEncoder({ label: 'pool' });
    const [own, others] = [this, before].map(({ planes }) => planes.pagesFor(STREAM_PRECISION).pages);
    for (const { from, to, count } of moves) {
      const [source, target] = [before.#placeOf(from), this.#placeOf(to)];
      const move = { from: source.chunk, to: target.chunk, count };
      copyChunks(encoder, others[source.page], own[target.page], move, SPLAT_WORDS, this.#of.scene.shDegree);
    }
    this.#context.device.queue.submit([encoder.finish()]);
    before.planes.destroy();
  }

  #ownWords(): Float32Array<ArrayBuffer> {
    if (this.#isGivenAway) this.#words = this.#words.slice();
    this.#isGivenAway = false;
    return this.#words;
  }

  /** The page of a chunk, and its index within the page. */
  #placeOf(chunk: number): { readonly page: number; readonly chunk: number } {
    const page = this.#starts.findLastIndex((start) => start <= chunk);
    return { page, chunk: chunk - this.#starts[page] };
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

/** Words of `Chunk` structs with the log scale ranges of `cells`, without bounds. */
export function chunksWithoutBounds(cells: readonly BrickCell[]): Float32Array<ArrayBuffer> {
  const chunks = new Float32Array(CHUNK_WORDS.count * cells.length);
  for (const [i, { logScales }] of cells.entries())
    setLogScales(chunks, i, { min: logScales[0], step: logScales[1] });
  return chunks;
}
