import { CHUNK_WORDS } from '../data/layout/chunk-words.ts';
import { CHUNK_SPLATS } from '../data/layout/constants.ts';
import { ChunkLinks, LEVEL_CONSTANTS, LevelCell, MergeParameters } from '../data/layout/level-structs.ts';
import { chunkCountOf } from '../data/packing/chunks.ts';
import { GEOMETRY_WORDS } from '../data/packing/geometry.ts';
import { shWordsPerSplat } from '../data/packing/harmonics.ts';
import { BLOB_PRECISION, type CloudPrecision } from '../data/packing/precision.ts';
import type { GpuMemory } from '../gpu/gpu-memory.ts';
import type { StageDefinition } from '../gpu/pipelines.ts';
import { mergeChunks } from '../gpu/stages/merge-chunks.ts';
import { mergeHarmonics } from '../gpu/stages/merge-harmonics.ts';
import type { CloudPage, CloudPlanes } from './cloud-planes.ts';
import { type DispatchContext, Dispatches } from './ingest/dispatches.ts';

const { CELL_CHILDREN, NO_CELL } = LEVEL_CONSTANTS;
/** Chunks of a cell of an upper level: its leaves and its blobs. */
const UPPER_CHUNKS = 2;
const LINKS_BYTES = 4 * ChunkLinks.words;

/** Levels are made of the finest planes that a cloud holds. */
const FINEST: CloudPrecision = { geometryPrecision: 'f32', shPrecision: 'f32' };

/** One page of blobs, with the links of its slots. */
export interface BlobPage extends CloudPage {
  readonly links: GPUBuffer;
}

/** Cells of each level, from that of the chunks to the one cell at the top. */
export function cellCounts(chunkCount: number): number[] {
  const counts = [chunkCount];
  while (counts.at(-1)! > 1) counts.push(Math.ceil(counts.at(-1)! / CELL_CHILDREN));
  return counts;
}

/** The contents of a cloud's buffer of cells, of the `Chunk` structs of its chunks. */
export function cellsOf(chunks: Float32Array): ArrayBuffer {
  const { count: words, minPosition, maxPosition } = CHUNK_WORDS;
  const counts = cellCounts(chunks.length / words);
  const total = counts.reduce((sum, count) => sum + count, 0);
  const contents = new ArrayBuffer(total * LevelCell.bytes);
  let below: { min: number[]; max: number[] }[] = Array.from({ length: counts[0] }, (_, chunk) => ({
    min: Array.from(chunks.subarray(chunk * words + minPosition, chunk * words + minPosition + 3)),
    max: Array.from(chunks.subarray(chunk * words + maxPosition, chunk * words + maxPosition + 3)),
  }));
  let start = 0;
  for (const [level, count] of counts.entries()) {
    const next = start + count;
    for (const [i, { min, max }] of below.entries()) {
      const parent = level + 1 < counts.length ? next + Math.floor(i / CELL_CHILDREN) : NO_CELL;
      const cell = { minPosition: min, maxPosition: max, parent };
      LevelCell.write(contents, cell, (start + i) * LevelCell.bytes);
    }
    below = Array.from({ length: counts[level + 1] ?? 0 }, (_, i) => {
      const children = below.slice(i * CELL_CHILDREN, (i + 1) * CELL_CHILDREN);
      const along = (pick: (...values: number[]) => number, side: 'min' | 'max') =>
        [0, 1, 2].map((axis) => pick(...children.map((child) => child[side][axis])));
      return { min: along(Math.min, 'min'), max: along(Math.max, 'max') };
    });
    start = next;
  }
  return contents;
}

/** The parts of a cloud that its levels are made of. */
export interface LevelSource {
  readonly name: string;
  readonly count: number;
  /** One `Chunk` struct per chunk. */
  readonly chunks: ArrayBuffer;
  readonly planes: CloudPlanes;
}

type MadeLevels = Pick<CloudLevels, 'cellCount' | 'cells' | 'splatLinks' | 'blobPages' | 'counts'>;

/** The levels of detail of a cloud, on the GPU: blobs that stand for its splats. */
export class CloudLevels {
  readonly cellCount: number;
  readonly cells: GPUBuffer;
  /** Links of the splats, by page of the cloud. */
  readonly splatLinks: readonly GPUBuffer[];
  /** Blobs of the chunks, by page of the cloud; then the leaves and blobs of all upper levels. */
  readonly blobPages: readonly BlobPage[];
  /** Cells of each level, from that of the chunks on. */
  readonly counts: readonly number[];
  readonly #memory: GpuMemory;

  private constructor(memory: GpuMemory, made: MadeLevels) {
    this.#memory = memory;
    this.cellCount = made.cellCount;
    this.cells = made.cells;
    this.splatLinks = made.splatLinks;
    this.blobPages = made.blobPages;
    this.counts = made.counts;
  }

  /** Stages that making the levels of a cloud takes. */
  static stages({ planes }: LevelSource): readonly StageDefinition[] {
    const { shDegree } = planes;
    const { geometryPrecision, shPrecision } = planes.pagesFor(FINEST);
    return [
      mergeChunks(geometryPrecision),
      mergeChunks('upper'),
      ...(shDegree > 0
        ? [mergeHarmonics(shDegree, { geometryPrecision, shPrecision }), mergeHarmonics(shDegree, 'upper')]
        : []),
    ];
  }

  /**
   * Makes the levels of `cloud`, by stages that are compiled.
   *
   * @throws GpuLimitError if the device has no room for them; nothing is left allocated then.
   */
  static make(context: DispatchContext, cloud: LevelSource): CloudLevels {
    const memory = context.memory.part();
    try {
      return new CloudLevels(memory, makeLevels({ ...context, memory }, cloud));
    } catch (error) {
      memory.destroyAll();
      throw error;
    }
  }

  get bytes(): number {
    return this.#memory.report().totalBytes;
  }

  destroy(): void {
    this.#memory.destroyAll();
  }
}

function makeLevels(context: DispatchContext, cloud: LevelSource): MadeLevels {
  const { memory } = context;
  const { name, planes } = cloud;
  const { shDegree } = planes;
  const { pages } = planes.pagesFor(FINEST);
  const [mergeSplats, mergeUpper, mergeSh, mergeUpperSh] = CloudLevels.stages(cloud);
  const contents = cellsOf(new Float32Array(cloud.chunks));
  const cells = memory.createFilledBuffer(`${name} cells`, new Uint32Array(contents));
  const usage = GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_SRC;
  const linksOf = (chunkCount: number, what: string) =>
    memory.createBuffer(`${name} ${what} links`, LINKS_BYTES * chunkCount, usage);
  const blobPage = (chunkCount: number, what: string): BlobPage => {
    const splatCount = CHUNK_SPLATS * chunkCount;
    const plane = (words: number, of: string) =>
      memory.createBuffer(`${name} ${what} ${of}`, 4 * words * splatCount, usage);
    return {
      splatCount,
      chunkCount,
      geometry: plane(GEOMETRY_WORDS[BLOB_PRECISION.geometryPrecision], 'geometry'),
      shRest:
        shDegree > 0
          ? plane(shWordsPerSplat(shDegree, BLOB_PRECISION.shPrecision), 'spherical harmonics')
          : null,
      // Bounds are those of cells.
      chunks: cells,
      links: linksOf(chunkCount, what),
    };
  };
  const counts = cellCounts(chunkCountOf(cloud.count));
  const upperStart = counts[0];
  const cellCount = counts.reduce((sum, count) => sum + count, 0);
  const splatLinks = pages.map(({ chunkCount }) => linksOf(chunkCount, 'splat'));
  const ofChunks = pages.map(({ chunkCount }) => blobPage(chunkCount, 'blob'));
  const upper = blobPage(Math.max(1, UPPER_CHUNKS * (cellCount - upperStart)), 'upper blob');

  const dispatches = new Dispatches(context);
  const upperBindings = { cells, upper: upper.geometry, upperLinks: upper.links };
  const shBindings = shDegree > 0 ? { upperSh: upper.shRest! } : null;
  let levelStart = 0;
  for (const [level, count] of counts.entries()) {
    const common = {
      levelStart,
      nextLevelStart: levelStart + count,
      upperStart,
      hasNextLevel: level + 1 < counts.length ? 1 : 0,
      dispatchRow: context.dispatchRow,
    };
    const add = (
      stages: readonly [StageDefinition, StageDefinition | undefined],
      firstCell: number,
      cellCount: number,
      splatCount: number,
      bindings: Readonly<Record<string, GPUBuffer>>,
    ) => {
      const parameters = MergeParameters.pack({ ...common, firstCell, cellCount, splatCount });
      for (const stage of stages)
        if (stage)
          dispatches.add(stage, parameters, { ...upperBindings, ...shBindings, ...bindings }, cellCount);
    };
    if (level > 0) add([mergeUpper, mergeUpperSh], levelStart, count, 0, {});
    else {
      for (const [i, page] of pages.entries()) {
        const { geometry, shRest, chunks, splatCount } = page;
        const blobs = ofChunks[i];
        add([mergeSplats, mergeSh], planes.ranges[i].start / CHUNK_SPLATS, page.chunkCount, splatCount, {
          splats: geometry,
          chunks,
          splatLinks: splatLinks[i],
          blobs: blobs.geometry,
          blobLinks: blobs.links,
          ...(shRest && { shRest, blobSh: blobs.shRest! }),
        });
      }
    }
    levelStart += count;
  }
  dispatches.submit(`${name} levels`);
  const blobPages = counts.length > 1 ? [...ofChunks, upper] : ofChunks;
  return { cellCount, counts, cells, splatLinks, blobPages };
}
