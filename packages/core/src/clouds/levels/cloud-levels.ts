import { cellCounts, childCell } from '../../data/layout/cell-counts.ts';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { ChunkLinks, MergeParameters } from '../../data/layout/level-structs.ts';
import { chunkCountOf } from '../../data/packing/chunks.ts';
import { GEOMETRY_WORDS } from '../../data/packing/geometry.ts';
import { shWordsPerSplat } from '../../data/packing/harmonics.ts';
import { BLOB_PRECISION, type CloudPrecision } from '../../data/packing/precision.ts';
import type { GpuMemory } from '../../gpu/gpu-memory.ts';
import type { Bindings, StageDefinition } from '../../gpu/pipelines.ts';
import { SubmissionPacer } from '../../gpu/timing/submission-pacer.ts';
import { mergeChunks, mergeHarmonics } from '../../stages/merge/merge.ts';
import type { CloudPlanes } from '../cloud-planes.ts';
import { type DispatchContext, Dispatches } from '../ingest/dispatches.ts';
import { cellsOf } from './level-cells.ts';
import type { BlobPage, Levels } from './levels.ts';
import { type CellRange, TOUCH_STAGES, TouchedLinks } from './touched-links.ts';

/** Chunks per cell of an upper level: one of leaves and one of blobs. */
const UPPER_CHUNKS = 2;
const LINKS_BYTES = 4 * ChunkLinks.words;

/** Upper estimate of the time to merge one cell, on the slowest devices. */
const SLOWEST_CELL_MS = 25;
/** The pacer of submissions treats all merging as one kind of work. */
const WORK = 'merge';
/** Advice in the error if the device lacks memory for levels. */
const ADVICE = 'Draw it in full detail, or load fewer splats.';

/** Levels are made of the finest planes that a cloud holds. */
const FINEST: CloudPrecision = { geometryPrecision: 'f32', shPrecision: 'f32' };

/** The properties of a cloud that its levels are made from. */
export interface LevelSource {
  readonly name: string;
  readonly count: number;
  /** One `Chunk` struct per chunk. */
  readonly chunks: ArrayBuffer;
  readonly planes: CloudPlanes;
}

/** The services of an engine that making levels needs. */
export interface LevelContext extends DispatchContext {
  /** See `EngineOptions.submissionBudgetMs`. */
  readonly submissionBudgetMs: number;
}

type MadeLevels = Pick<
  CloudLevels,
  'cellCount' | 'cells' | 'splatLinks' | 'blobPages' | 'counts' | 'chunks' | 'ranges'
>;

/** The levels of detail of a cloud that is wholly on the GPU: blobs that merge its splats. */
export class CloudLevels implements Levels {
  readonly cellCount: number;
  readonly cells: GPUBuffer;
  /** Links of the splats, per page of the cloud. */
  readonly splatLinks: readonly GPUBuffer[];
  /**
   * One page of chunk blobs per page of the cloud, then one page for the leaves and blobs of all
   * upper levels.
   */
  readonly blobPages: readonly BlobPage[];
  /** Cells per level; entry 0 counts chunks. */
  readonly counts: readonly number[];
  /** The cloud's chunks at the time of making, from which the cells' bounds follow. */
  readonly chunks: ArrayBuffer;
  /** All cells, level by level. */
  readonly ranges: readonly CellRange[];
  readonly #memory: GpuMemory;

  private constructor(memory: GpuMemory, made: MadeLevels) {
    this.#memory = memory;
    this.cellCount = made.cellCount;
    this.cells = made.cells;
    this.splatLinks = made.splatLinks;
    this.blobPages = made.blobPages;
    this.counts = made.counts;
    this.chunks = made.chunks;
    this.ranges = made.ranges;
  }

  /**
   * Makes the levels of `cloud`. The work is split into submissions, so that frames can be drawn in
   * between. Each should stay within the budget, judged by the times of earlier ones.
   *
   * @param check throws to end the work, for instance because the cloud has been destroyed.
   * @throws GpuLimitError if the device lacks the memory; errors of `check`. Nothing is left
   *   allocated then.
   */
  static async make(context: LevelContext, cloud: LevelSource, check: () => void): Promise<CloudLevels> {
    const memory = context.memory.part();
    try {
      for (;;) {
        const made = await makeLevels({ ...context, memory }, cloud, check);
        if (made) return new CloudLevels(memory, made);
        memory.destroyAll();
      }
    } catch (error) {
      memory.destroyAll();
      throw error;
    }
  }

  readonly refinement = {
    stages: TOUCH_STAGES,
    make: (context: DispatchContext) => new TouchedLinks(context, this),
  };

  get chunkCells(): number {
    return this.counts[0];
  }

  levelOf(cell: number): number {
    let end = 0;
    return this.counts.findIndex((count) => {
      end += count;
      return cell < end;
    });
  }

  childCell(cell: number, slot: number): number {
    return childCell(this.counts, { cell, slot });
  }

  get bytes(): number {
    return this.#memory.report().totalBytes;
  }

  destroy(): void {
    this.#memory.destroyAll();
  }
}

/**
 * Stages that merge splats, then stages that merge blobs of upper levels. Harmonics have a stage if
 * the degree is above 0.
 */
function mergeStages({ planes }: LevelSource): readonly (readonly StageDefinition[])[] {
  const { shDegree } = planes;
  const { geometryPrecision, shPrecision } = planes.pagesFor(FINEST);
  const ofSplats = [mergeChunks(geometryPrecision)];
  const ofBlobs = [mergeChunks('upper')];
  if (shDegree === 0) return [ofSplats, ofBlobs];
  return [
    [...ofSplats, mergeHarmonics(shDegree, { geometryPrecision, shPrecision })],
    [...ofBlobs, mergeHarmonics(shDegree, 'upper')],
  ];
}

/** Cells that share stages, bindings and parameters of merging. */
interface MergedRange extends CellRange {
  readonly stages: readonly StageDefinition[];
  readonly bindings: Bindings;
}

/** Returns null if the planes of the cloud change meanwhile. */
async function makeLevels(
  context: LevelContext,
  cloud: LevelSource,
  check: () => void,
): Promise<MadeLevels | null> {
  const { device, memory, pipelines } = context;
  const { name, planes } = cloud;
  const { held } = planes;
  const guarded = async <Result>(work: () => Result): Promise<Result> => {
    const { result, checked } = memory.guard(`${name} in levels`, ADVICE, work);
    await checked;
    return result;
  };
  await pipelines.prepare(mergeStages(cloud).flat());
  check();
  if (planes.held !== held) return null;
  const { levels, ranges } = await guarded(() => allocate(context, cloud));
  check();
  const { cellCount } = levels;
  const slowestMs = new Float64Array(cellCount + 1).map((_, cell) => SLOWEST_CELL_MS * cell);
  const pacer = new SubmissionPacer(context.submissionBudgetMs);
  for (let first = 0; first < cellCount; ) {
    if (planes.held !== held) return null;
    const end = Math.min(first + pacer.unitsFrom(first, WORK, slowestMs), cellCount);
    const submittedMs = performance.now();
    await guarded(() => submitCells(context, name, ranges, first, end));
    // The device reports its loss elsewhere.
    await device.queue.onSubmittedWorkDone().catch(() => {});
    check();
    pacer.take(
      [{ stage: WORK, slowestMs: slowestMs[end] - slowestMs[first] }],
      performance.now() - submittedMs,
    );
    first = end;
  }
  return levels;
}

/** Submits the merging of cells in order, because each level is made from the one below. */
function submitCells(
  context: LevelContext,
  name: string,
  ranges: readonly MergedRange[],
  first: number,
  end: number,
): void {
  const dispatches = new Dispatches(context);
  for (const { start, end: rangeEnd, stages, parameters, bindings } of ranges) {
    const [firstCell, endCell] = [Math.max(start, first), Math.min(rangeEnd, end)];
    if (firstCell >= endCell) continue;
    const packed = MergeParameters.pack({ ...parameters, firstCell, endCell });
    for (const stage of stages) dispatches.add(stage, packed, bindings, endCell - firstCell);
  }
  dispatches.submit(`${name} levels`);
}

/** Allocates the buffers for the levels of a cloud. */
function allocate(
  { memory, dispatchRow }: LevelContext,
  cloud: LevelSource,
): { readonly levels: MadeLevels; readonly ranges: readonly MergedRange[] } {
  const { name, planes } = cloud;
  const { shDegree } = planes;
  const { pages } = planes.pagesFor(FINEST);
  const [ofSplats, ofBlobs] = mergeStages(cloud);
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
      // Blobs have no chunks of their own; their cells hold the bounds.
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

  const upperBindings = {
    cells,
    upper: upper.geometry,
    upperLinks: upper.links,
    ...(shDegree > 0 && { upperSh: upper.shRest! }),
  };
  const ranges: MergedRange[] = [];
  let levelStart = 0;
  for (const [level, count] of counts.entries()) {
    const nextLevelStart = levelStart + count;
    const hasNextLevel = level + 1 < counts.length ? 1 : 0;
    const ofLevel = { levelStart, nextLevelStart, upperStart, hasNextLevel, dispatchRow };
    if (level > 0) {
      const parameters = { ...ofLevel, pageStart: levelStart, splatCount: 0 };
      ranges.push({
        start: levelStart,
        end: nextLevelStart,
        page: null,
        stages: ofBlobs,
        parameters,
        bindings: upperBindings,
      });
    } else {
      for (const [i, page] of pages.entries()) {
        const { geometry, shRest, chunks, splatCount, chunkCount } = page;
        const blobs = ofChunks[i];
        const start = planes.ranges[i].start / CHUNK_SPLATS;
        const bindings = {
          ...upperBindings,
          splats: geometry,
          chunks,
          splatLinks: splatLinks[i],
          blobs: blobs.geometry,
          blobLinks: blobs.links,
          ...(shRest && { shRest, blobSh: blobs.shRest! }),
        };
        const parameters = { ...ofLevel, pageStart: start, splatCount };
        ranges.push({ start, end: start + chunkCount, page: i, stages: ofSplats, parameters, bindings });
      }
    }
    levelStart = nextLevelStart;
  }
  const blobPages = counts.length > 1 ? [...ofChunks, upper] : ofChunks;
  const { chunks } = cloud;
  const ofCells = ranges.map(({ start, end, page, parameters }) => ({ start, end, page, parameters }));
  return {
    levels: { cellCount, counts, cells, splatLinks, blobPages, chunks, ranges: ofCells },
    ranges,
  };
}
