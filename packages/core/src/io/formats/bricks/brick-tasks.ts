import type { Brick, BrickCell } from '../../../data/bricks/brick.ts';
import { CellMerger } from '../../../data/bricks/cell-merger.ts';
import { BLOB_WORDS, blobReader, leafReader } from '../../../data/bricks/leaf-reader.ts';
import { type Blobs, type Leaves, mergeCell } from '../../../data/bricks/merge-cell.ts';
import { CHUNK_WORDS } from '../../../data/layout/chunk-words.ts';
import { CHUNK_SPLATS } from '../../../data/layout/constants.ts';
import { LEVEL_CONSTANTS } from '../../../data/layout/level-structs.ts';
import { centerBounds } from '../../../data/packing/center-bounds.ts';
import { chunkCountOf, logScalesOf, maxScaleOf } from '../../../data/packing/chunks.ts';
import { packGeometry } from '../../../data/packing/geometry.ts';
import { type Harmonics, type PackedHarmonics, shWordsPerSplat } from '../../../data/packing/harmonics.ts';
import {
  MORTON_DIGITS,
  type MortonFrame,
  mortonDigits,
  mortonOrder,
} from '../../../data/packing/morton-order.ts';
import type { Bounds } from '../../../data/packing/packed-cloud.ts';
import { BLOB_PRECISION } from '../../../data/packing/precision.ts';
import type { ShDegree, SplatColumns, SplatSet } from '../../../data/splats/splat-set.ts';
import { Turns } from '../../../data/turns.ts';
import { packZlib } from '../../containers/pack-gzip.ts';
import { type Rounding, RoundingMeter } from '../rows/rounding-meter.ts';
import {
  joinRecords,
  type RecordFacts,
  type Records,
  recordsOf,
  recordWords,
  splatsOfRecords,
} from './brick-records.ts';
import { POSITION_BITS } from './bricks-layout.ts';
import { encodeGeometry } from './encode-geometry.ts';
import { encodeHarmonics } from './encode-harmonics.ts';

const { CELL_CHILDREN, CELL_ROOTS } = LEVEL_CONSTANTS;
const { minPosition, maxPosition } = CHUNK_WORDS;
/** Words of a cell's bounds: least x, y, z, then largest. */
export const BOUNDS_WORDS = 6;
/** Leaves of a full brick. */
export const BRICK_LEAVES = CELL_CHILDREN * CHUNK_SPLATS;
const NOTHING = new Uint8Array(0);

/** Facts about all splats of a scene. */
export interface SceneFacts extends RecordFacts {
  readonly frame: MortonFrame;
  readonly splatCount: number;
  /** Median size of the splats, in scene units: see `splatSize`. */
  readonly medianSize: number;
}

/** Converts splats to records. */
interface RecordsTask {
  readonly kind: 'records';
  readonly set: SplatSet<Harmonics>;
}

/** Counts records by a digit of their Morton codes. */
interface CountTask {
  readonly kind: 'count';
  readonly parts: readonly Records[];
  readonly facts: SceneFacts;
  /** Bit position of the digit: see `mortonDigits`. */
  readonly shift: number;
}

/** Divides records into buckets by the same digit. */
export interface DivideTask extends Omit<CountTask, 'kind'> {
  readonly kind: 'divide';
  /** Bucket index for each digit. */
  readonly buckets: Uint32Array;
  readonly bucketCount: number;
}

/** Makes bricks of the lowest level from the records of one bucket. */
export interface SplatsTask {
  readonly kind: 'splats';
  readonly parts: readonly Records[];
  readonly facts: SceneFacts;
  /** Index of the bucket's first splat in storage order. */
  readonly first: number;
  /** Every n-th splat is sampled for robust bounds. */
  readonly boundsStep: number;
}

/** Makes bricks of an upper level from its cells: a multiple of sixteen cells, or all that are left. */
interface BlobsTask {
  readonly kind: 'blobs';
  readonly level: number;
  readonly degree: ShDegree;
  readonly leaves: Blobs;
  /** Number of leaves of the last cell; all other cells are full. */
  readonly lastLeaves: number;
  readonly bounds: Float32Array<ArrayBuffer>;
  /** Errors of the child cells. */
  readonly childErrors: Uint16Array<ArrayBuffer>;
}

/** A part of the work of writing bricks. It depends on its own data alone, so any thread can do it. */
export type BrickTask = RecordsTask | CountTask | DivideTask | SplatsTask | BlobsTask;

/** Consecutive encoded bricks, with the facts about their cells that the level above needs. */
export interface BricksMade {
  /** Bytes of geometry and bytes of harmonics, two numbers per brick. */
  readonly sizes: Uint32Array<ArrayBuffer>;
  /** Geometry and harmonics of all bricks, one after another. */
  readonly bytes: Uint8Array<ArrayBuffer>;
  /** BOUNDS_WORDS numbers per cell. */
  readonly bounds: Float32Array<ArrayBuffer>;
  /** Largest standard deviation per cell of the lowest level, in scene units; empty above. */
  readonly largestScales: Float32Array<ArrayBuffer>;
  readonly errors: Uint16Array<ArrayBuffer>;
  /** Blobs of the cells' roots, with room for sixteen per cell. */
  readonly roots: Blobs;
}

interface Results {
  readonly records: Records & { readonly bounds: Bounds };
  /** Number of records for each digit. */
  readonly count: Uint32Array<ArrayBuffer>;
  readonly divide: {
    /** Records by bucket, each bucket in the order of arrival. */
    readonly words: Uint32Array<ArrayBuffer>;
    /** Number of records in each bucket. */
    readonly counts: Uint32Array<ArrayBuffer>;
  };
  readonly splats: BricksMade & {
    /** Index of the first splat of the first brick. */
    readonly first: number;
    /** Sorted records of at most two bricks that share splats with other buckets. */
    readonly fragments: readonly { readonly first: number; readonly words: Uint32Array<ArrayBuffer> }[];
    /** Positions sampled for robust bounds. */
    readonly samples: Float32Array<ArrayBuffer>;
    /** Rounding errors of the splats in these bricks. */
    readonly rounding: Rounding;
  };
  readonly blobs: BricksMade;
}

/** The result of a task. */
export type BrickResult<Task extends BrickTask = BrickTask> = Results[Task['kind']];

/** Packs bytes as a zlib stream at the default level. */
export type PackZlib = (
  bytes: Uint8Array<ArrayBuffer>,
) => Uint8Array<ArrayBuffer> | Promise<Uint8Array<ArrayBuffer>>;

/** Runs a task in any thread. Rejects as `BrickWriter`. */
export async function runTask(task: BrickTask, pack: PackZlib = packZlib): Promise<BrickResult> {
  switch (task.kind) {
    case 'records':
      return recordsOf(task.set);
    case 'count':
      return countRecords(task);
    case 'divide':
      return divideRecords(task);
    case 'splats':
      return bricksOfSplats(task, pack);
    case 'blobs':
      return bricksOfBlobs(task, pack);
  }
}

function digitsOf(words: Uint32Array<ArrayBuffer>, { facts, shift }: CountTask | DivideTask): Uint32Array {
  const floats = new Float32Array(words.buffer, words.byteOffset, words.length);
  return mortonDigits(floats, recordWords(facts.degree), facts.frame, shift);
}

function countRecords(task: CountTask): Uint32Array<ArrayBuffer> {
  const counts = new Uint32Array(MORTON_DIGITS);
  for (const part of task.parts)
    for (const digit of digitsOf(joinRecords([part], task.facts), task)) counts[digit]++;
  return counts;
}

function divideRecords(task: DivideTask): Results['divide'] {
  const records = joinRecords(task.parts, task.facts);
  const width = recordWords(task.facts.degree);
  const buckets = digitsOf(records, task).map((digit) => task.buckets[digit]);
  const counts = new Uint32Array(task.bucketCount);
  for (const bucket of buckets) counts[bucket]++;
  const next = new Uint32Array(task.bucketCount);
  for (let bucket = 1; bucket < next.length; bucket++) next[bucket] = next[bucket - 1] + counts[bucket - 1];
  const words = new Uint32Array(records.length);
  for (let i = 0; i < buckets.length; i++) {
    const [from, to] = [i * width, next[buckets[i]]++ * width];
    for (let k = 0; k < width; k++) words[to + k] = records[from + k];
  }
  return { words, counts };
}

async function bricksOfSplats(
  { parts, facts, first, boundsStep }: SplatsTask,
  pack: PackZlib,
): Promise<Results['splats']> {
  const { degree, frame, splatCount } = facts;
  const records = joinRecords(parts, facts);
  const width = recordWords(degree);
  const count = records.length / width;
  const floats = new Float32Array(records.buffer, records.byteOffset, records.length);
  const positions = new Float32Array(3 * count);
  for (let i = 0; i < count; i++)
    for (let axis = 0; axis < 3; axis++) positions[3 * i + axis] = floats[i * width + axis];
  const order = mortonOrder(positions, count, frame);
  const end = first + count;
  const from = Math.min(end, Math.ceil(first / BRICK_LEAVES) * BRICK_LEAVES);
  // Only the last brick of the scene may be partly filled.
  const to = end === splatCount ? end : Math.max(from, Math.floor(end / BRICK_LEAVES) * BRICK_LEAVES);
  const fragmentOf = (start: number, stop: number) => {
    const words = new Uint32Array((stop - start) * width);
    for (let i = start; i < stop; i++) {
      const at = order[i - first] * width;
      words.set(records.subarray(at, at + width), (i - start) * width);
    }
    return { first: start, words };
  };
  const fragments = [fragmentOf(first, from), fragmentOf(to, end)].filter(({ words }) => words.length > 0);
  const sampled: number[] = [];
  for (let i = Math.ceil(from / boundsStep) * boundsStep; i < to; i += boundsStep) {
    const at = 3 * order[i - first];
    sampled.push(positions[at], positions[at + 1], positions[at + 2]);
  }
  const maker = new BrickMaker(0, degree, chunkCountOf(to - from), pack);
  const meter = new RoundingMeter(facts.medianSize);
  for (let start = from; start < to; start += BRICK_LEAVES) {
    const stop = Math.min(to, start + BRICK_LEAVES);
    const splats = splatsOfRecords(records, order.subarray(start - first, stop - first), facts);
    for (let chunk = 0; chunk < splats.count; chunk += CHUNK_SPLATS)
      measureChunk(splats, chunk, Math.min(splats.count, chunk + CHUNK_SPLATS), meter);
    await maker.addSplats(splats);
  }
  const samples = Float32Array.from(sampled);
  return { ...maker.made(), first: from, fragments, samples, rounding: meter.rounding };
}

/** Adds the rounding errors of a chunk, whose splats share one bounding box. */
function measureChunk(splats: SplatColumns, from: number, to: number, meter: RoundingMeter): void {
  const { min, max } = centerBounds(splats.positions.subarray(3 * from), to - from);
  const step = Math.max(max[0] - min[0], max[1] - min[1], max[2] - min[2]) / (2 ** POSITION_BITS - 1);
  for (let i = from; i < to; i++) meter.position(splats, i, step);
}

async function bricksOfBlobs(task: BlobsTask, pack: PackZlib): Promise<BricksMade> {
  const { level, degree, lastLeaves, bounds } = task;
  const cellCount = bounds.length / BOUNDS_WORDS;
  const maker = new BrickMaker(level, degree, cellCount, pack);
  for (let first = 0; first < cellCount; first += CELL_CHILDREN) {
    const end = Math.min(cellCount, first + CELL_CHILDREN);
    await maker.addBlobs(task, first, end, end === cellCount ? lastLeaves : CHUNK_SPLATS);
  }
  return maker.made();
}

/** Encodes the bricks of one level, one after another. */
class BrickMaker {
  readonly #level: number;
  readonly #degree: ShDegree;
  readonly #pack: PackZlib;
  readonly #turns = new Turns(undefined);
  readonly #merger = new CellMerger();
  readonly #parts: Uint8Array<ArrayBuffer>[] = [];
  readonly #bounds: Float32Array<ArrayBuffer>;
  readonly #largestScales: Float32Array<ArrayBuffer>;
  readonly #errors: Uint16Array<ArrayBuffer>;
  readonly #roots: Blobs;
  #cells = 0;

  constructor(level: number, degree: ShDegree, cellCount: number, pack: PackZlib) {
    this.#level = level;
    this.#degree = degree;
    this.#pack = pack;
    this.#bounds = new Float32Array(BOUNDS_WORDS * cellCount);
    this.#largestScales = new Float32Array(level === 0 ? cellCount : 0);
    this.#errors = new Uint16Array(cellCount);
    this.#roots = {
      geometry: new Uint32Array(cellCount * CELL_ROOTS * BLOB_WORDS),
      harmonics: new Uint32Array(
        cellCount * CELL_ROOTS * shWordsPerSplat(degree, BLOB_PRECISION.shPrecision),
      ),
    };
  }

  /** Encodes a brick of splats in storage order. */
  async addSplats(splats: SplatSet<PackedHarmonics>): Promise<void> {
    const { words, chunks } = packGeometry(splats, 'packed');
    const first = this.#cells;
    const ranges = [];
    for (let chunk = 0; chunk < chunkCountOf(splats.count); chunk++) {
      const at = chunk * CHUNK_WORDS.count;
      const to = BOUNDS_WORDS * (first + chunk);
      this.#bounds.set(chunks.subarray(at + minPosition, at + minPosition + 3), to);
      this.#bounds.set(chunks.subarray(at + maxPosition, at + maxPosition + 3), to + 3);
      this.#largestScales[first + chunk] = maxScaleOf(chunks, chunk);
      ranges.push(logScalesOf(chunks, chunk));
    }
    const geometry = words as Uint32Array<ArrayBuffer>;
    const harmonics = splats.harmonics.words as Uint32Array<ArrayBuffer>;
    const leaves = { read: leafReader(words, ranges), harmonics: splats.harmonics };
    const cells = ranges.map(({ min, step }, i) =>
      this.#cell(first + i, Math.min(CHUNK_SPLATS, splats.count - CHUNK_SPLATS * i), [min, step]),
    );
    await this.#add({ cells, geometry, harmonics }, leaves);
  }

  /** Encodes a brick of the cells from `first` to before `end` of a task. */
  async addBlobs(task: BlobsTask, first: number, end: number, lastLeaves: number): Promise<void> {
    this.#bounds.set(task.bounds.subarray(BOUNDS_WORDS * first, BOUNDS_WORDS * end), BOUNDS_WORDS * first);
    const shWords = shWordsPerSplat(this.#degree, BLOB_PRECISION.shPrecision);
    const wordsOf = (words: Uint32Array<ArrayBuffer>, each: number) =>
      words.subarray(first * CHUNK_SPLATS * each, end * CHUNK_SPLATS * each);
    const geometry = wordsOf(task.leaves.geometry, BLOB_WORDS);
    const harmonics = wordsOf(task.leaves.harmonics, shWords);
    const { shPrecision: precision } = BLOB_PRECISION;
    const packed = { degree: this.#degree, precision, wordsPerSplat: shWords, words: harmonics };
    const cells = Array.from({ length: end - first }, (_, i) =>
      this.#cell(first + i, first + i + 1 === end ? lastLeaves : CHUNK_SPLATS, [0, 0]),
    );
    const errors = task.childErrors.subarray(CELL_CHILDREN * first);
    await this.#add(
      { cells, geometry, harmonics },
      { read: blobReader(geometry), harmonics: packed },
      errors,
    );
  }

  made(): BricksMade {
    const bytes = new Uint8Array(this.#parts.reduce((sum, { length }) => sum + length, 0));
    let at = 0;
    for (const part of this.#parts) {
      bytes.set(part, at);
      at += part.length;
    }
    return {
      sizes: Uint32Array.from(this.#parts, ({ length }) => length),
      bytes,
      bounds: this.#bounds,
      largestScales: this.#largestScales,
      errors: this.#errors,
      roots: this.#roots,
    };
  }

  /** Metadata of a cell, as encoding the brick needs it. */
  #cell(cell: number, leafCount: number, logScales: BrickCell['logScales']): BrickCell {
    const [minX, minY, minZ, maxX, maxY, maxZ] = this.#boundsOf(cell);
    const bounds = { min: [minX, minY, minZ], max: [maxX, maxY, maxZ] } as const;
    return { bounds, leafCount, logScales, largestScale: 0, child: null, childErrors: [], childRoots: [] };
  }

  #boundsOf(cell: number): Float32Array {
    return this.#bounds.subarray(BOUNDS_WORDS * cell, BOUNDS_WORDS * (cell + 1));
  }

  async #add(
    leavesOfBrick: Pick<Brick, 'cells' | 'geometry' | 'harmonics'>,
    leaves: Leaves,
    childErrors?: Uint16Array,
  ): Promise<void> {
    await this.#turns.give();
    const brick = { ...leavesOfBrick, level: this.#level, fileIndices: new Uint32Array(0) };
    const degree = this.#degree;
    const packed = Promise.all([
      this.#pack(encodeGeometry(brick)),
      degree > 0 ? this.#pack(encodeHarmonics(brick, degree)) : NOTHING,
    ]);
    // Measured while other threads compress.
    for (const [i, { leafCount }] of brick.cells.entries()) {
      const cell = this.#cells++;
      this.#errors[cell] = mergeCell(
        this.#merger,
        {
          ...leaves,
          first: CHUNK_SPLATS * i,
          count: leafCount,
          childErrors: childErrors?.subarray(CELL_CHILDREN * i),
          bounds: this.#boundsOf(cell),
        },
        this.#roots,
        CELL_ROOTS * cell,
      );
    }
    for (const part of await packed) this.#parts.push(part);
  }
}
