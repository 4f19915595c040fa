import { BrickShape } from '../../../data/bricks/brick-shape.ts';
import { BLOB_WORDS } from '../../../data/bricks/leaf-reader.ts';
import { InvalidArgumentError } from '../../../data/errors.ts';
import { checkKind, given, wrongArgument } from '../../../data/given.ts';
import { inLanes } from '../../../data/in-lanes.ts';
import { CHUNK_SPLATS } from '../../../data/layout/constants.ts';
import { LEVEL_CONSTANTS } from '../../../data/layout/level-structs.ts';
import { guarded } from '../../../data/listeners.ts';
import type { Vec3 } from '../../../data/math/mat4.ts';
import { emptyBounds } from '../../../data/packing/center-bounds.ts';
import { trueShDegree } from '../../../data/packing/cloud-facts.ts';
import { type Harmonics, shWordsPerSplat } from '../../../data/packing/harmonics.ts';
import { cloudFrame, MORTON_DIGITS, MORTON_SHIFTS } from '../../../data/packing/morton-order.ts';
import { chooseOrigin } from '../../../data/packing/origin.ts';
import { type Bounds, boundsStep, robustBounds } from '../../../data/packing/packed-cloud.ts';
import { PositionSample } from '../../../data/packing/position-sample.ts';
import { BLOB_PRECISION } from '../../../data/packing/precision.ts';
import { givenSet } from '../../../data/splats/check-set.ts';
import { checkStill } from '../../../data/splats/columns.ts';
import { agreedAntialiasing, type ShDegree, type SplatSet } from '../../../data/splats/splat-set.ts';
import { addRounding, type RoundingAdvice, RoundingMeter } from '../rows/rounding-meter.ts';
import type { PutBytes, WriteOptions } from '../write-format.ts';
import { writeBrickHeader } from './brick-header.ts';
import {
  type BrickJournal,
  bucketsName,
  checkEntry,
  type MadeEntry,
  MadeRanges,
  type StoredRun,
  type StoredSplats,
} from './brick-journal.ts';
import { movedCoordinate, type Records, recordWords } from './brick-records.ts';
import {
  BOUNDS_WORDS,
  BRICK_LEAVES,
  type BrickResult,
  type BricksMade,
  type BrickTask,
  type DivideTask,
  runTask,
  type SceneFacts,
} from './brick-tasks.ts';
import { brickHeaderBytes, FILE_HEADER_BYTES } from './bricks-layout.ts';
import { writeFileHeader } from './file-header.ts';
import { batchesOf, bucketsOf, countOf, runOf, Seams } from './record-runs.ts';
import { sliceOf } from './slice-set.ts';
import {
  type MakeTemporaryFile,
  memoryFile,
  readBack,
  sumOf,
  type TemporaryFile,
  wrongStorage,
} from './temporary-files.ts';
import { type StartedTask, WorkQueue } from './work-queue.ts';

const { CELL_CHILDREN, CELL_ROOTS } = LEVEL_CONSTANTS;

/** Temporary storage, threads and journal of a `BrickWriter`. */
export interface BrickWriterOptions {
  /** Creates a temporary file. Default: files in memory. */
  readonly makeFile?: MakeTemporaryFile;
  /**
   * Runs a task in any thread and resolves with the `result` of `runBrickTask`. Default: the
   * current thread.
   */
  readonly run?: (task: BrickTask) => Promise<BrickResult>;
  /** Number of tasks that `run` can process in parallel. Default: 1. */
  readonly threads?: number;
  /** Most splats that are sorted in memory at once, at least 4,096. Default: 65,536. */
  readonly bucketSplats?: number;
  /** Aborts the work, which then rejects with the signal's reason. */
  readonly signal?: AbortSignal;
  /** Log of finished work, so that another writer can resume: see `BrickWriter.resume`. */
  readonly journal?: BrickJournal;
}

/** Each takes about 100 bytes, and its bricks as much again. */
const BUCKET_SPLATS = 1 << 16;
/** Splats per task before they are sorted. */
const TASK_SPLATS = 1 << 17;
/** Splats of a set that are converted to records at once. */
const SLICE_SPLATS = 1 << 15;
/** Least number of buckets per thread, so that no thread idles at the end. */
const THREAD_BUCKETS = 4;
/** Bricks of upper levels per task. */
const TASK_BRICKS = 8;

const ADVICE: RoundingAdvice = {
  title: '.bricks',
  positions: 'Crop splats far outside of the others, or write PLY or glTF',
};

/** Progress at the end of each step, from 0 to 1. */
const PROGRESS = { counted: 0.03, divided: 0.1, splats: 0.9, blobs: 0.97, written: 1 } as const;

/** Records in order of arrival. */
interface StoredRecords {
  readonly open: () => Promise<TemporaryFile>;
  readonly runs: readonly StoredRun[];
}

/** Consecutive bricks in the file of a level. */
interface StoredBricks {
  readonly firstBrick: number;
  readonly count: number;
  readonly at: number;
  readonly byteCount: number;
  readonly sum: number | undefined;
}

/** A level whose bricks are being made. */
interface WrittenLevel {
  /** Geometry and harmonics of its bricks. */
  readonly bricks: TemporaryFile;
  readonly stored: StoredBricks[];
  byteCount: number;
  /** Roots of all cells: first their geometry, then their harmonics. */
  readonly roots: TemporaryFile;
  /** Checksum of these bytes by `sumOf`; undefined if unknown. */
  rootsSum: number | undefined;
  /** See `BricksMade`; all cells of the level. */
  readonly bounds: Float32Array<ArrayBuffer>;
  readonly largestScales: Float32Array<ArrayBuffer>;
  readonly errors: Uint16Array<ArrayBuffer>;
  /** See `BricksMade`; all bricks of the level. */
  readonly sizes: Uint32Array<ArrayBuffer>;
}

/** The lowest level, whose leaves are splats, while its bricks are made. */
interface LowestLevel {
  readonly facts: SceneFacts;
  readonly level: WrittenLevel;
  readonly seams: Seams;
  /** Sorted records of bricks that span several buckets, by the index of their first splat. */
  readonly whole: Map<number, Records>;
  /** Positions sampled for robust bounds. */
  readonly samples: Float32Array[];
  /** Rounding errors of the splats. */
  readonly meter: RoundingMeter;
  madeCells: number;
}

/** See `BrickWriter.temporaryBytes`. */
export function temporaryBytes(splatCount: number, degree: ShDegree): number {
  // Records as they arrived, and again in buckets. Bricks and roots are smaller, and follow the
  // removal of the first file.
  return 2 * 4 * recordWords(degree) * splatCount;
}

/**
 * Writes a scene of any size in bricks. `add` takes its splats piece by piece; `finish` writes the
 * file. The bytes equal the output of `writeSplats` for the whole scene.
 *
 * Splats are stored in a temporary file, as records of 56 bytes plus packed harmonics (48 bytes at
 * degree 3). Their Morton codes divide them into buckets, in a second file. Each bucket is sorted
 * and encoded by itself; the roots of its cells are kept for the level above. Memory holds one
 * bucket per thread.
 *
 * Always call `end`, also after an error.
 */
export class BrickWriter {
  readonly #makeFile: MakeTemporaryFile;
  readonly #bucketSplats: number;
  readonly #threads: number;
  readonly #queue: WorkQueue;
  readonly #signal: AbortSignal | undefined;
  readonly #files = new Set<TemporaryFile>();
  #arrived: TemporaryFile | undefined;
  #arrivedBytes = 0;
  readonly #runs: StoredRun[] = [];
  readonly #bounds: Bounds[] = [];
  readonly #told = new Set<boolean | undefined>();
  readonly #sample = new PositionSample();
  #slices = 0;
  #count = 0;
  #progress: (fraction: number) => void = () => {};
  readonly #journal: BrickJournal | undefined;
  /** Slices, source rows and splats covered by the journal. */
  #noted = { slices: 0, rows: 0, splats: 0 };
  /** Splats per bucket of each file, by `bucketsName`. */
  readonly #divided = new Map<string, readonly number[]>();
  readonly #made = new MadeRanges();
  /** Undefined until all splats have been added. */
  #lowest: LowestLevel | undefined;

  /** @throws InvalidArgumentError if an option is invalid. */
  constructor(options: BrickWriterOptions = {}) {
    const {
      makeFile = memoryFile,
      run = runTask,
      threads = 1,
      bucketSplats = BUCKET_SPLATS,
    } = given(options, { makeFile: 'a function?', run: 'a function?', journal: 'an object?' });
    if (options.journal) given(options.journal, { entries: 'a function', note: 'a function' }, 'journal');
    for (const [name, value] of Object.entries({ threads, bucketSplats }))
      if (!(Number.isSafeInteger(value) && value > 0))
        throw wrongArgument(name, value, 'a whole number, 1 or more');
    this.#makeFile = makeFile;
    this.#bucketSplats = bucketSplats;
    this.#threads = threads;
    this.#signal = options.signal;
    this.#journal = options.journal;
    this.#queue = new WorkQueue(run, threads);
  }

  /** Number of splats added so far. */
  get count(): number {
    return this.#count;
  }

  /** Whether the splats were trained with an antialias filter; undefined if the sets disagree. */
  get isAntialiased(): boolean | undefined {
    return agreedAntialiasing([...this.#told].map((each) => ({ isAntialiased: each })));
  }

  /**
   * Resumes the work of an earlier writer with the same journal. Call it before `add`. The journal
   * preserves the splats up to each `keep`, each division into buckets, and the bricks of each
   * bucket. Upper levels and the file are made again.
   *
   * Rejects as the journal does, and with InvalidArgumentError if no writer can have noted an
   * entry.
   *
   * @returns number of source rows that need not be added again.
   */
  async resume(): Promise<number> {
    const entries = this.#journal?.entries() ?? [];
    if (!(Symbol.asyncIterator in Object(entries) || Symbol.iterator in Object(entries)))
      throw wrongArgument('journal.entries', entries, 'a function that returns an async iterable');
    for await (const entry of entries) {
      checkEntry(entry);
      if (entry.kind === 'divided') this.#divided.set(bucketsName(entry.depth, entry.first), entry.sizes);
      else if (entry.kind === 'made') {
        if (this.#count === 0)
          throw wrongArgument('entry.kind', entry.kind, 'arrived, as no splats are there yet');
        this.#lowest ??= await this.#newLowest();
        checkPlaces(entry.made, this.#lowest);
        if (entry.range) this.#made.add(entry.range);
        else this.#lowest.whole.delete(entry.made.first);
        this.#lowest.level.rootsSum = undefined;
        this.#takeSplats(this.#lowest, entry);
      } else {
        for (const each of entry.told) this.#told.add(each ?? undefined);
        for (const each of entry.bounds) this.#bounds.push(each);
        for (const each of entry.runs) {
          this.#runs.push(each);
          this.#arrivedBytes = Math.max(this.#arrivedBytes, each.at + 4 * each.run.words * each.run.count);
        }
        this.#sample.addValues(entry.sample);
        this.#slices = this.#runs.length;
        this.#count += countOf(entry.runs);
        this.#noted = { slices: this.#slices, rows: entry.rows, splats: this.#count };
      }
    }
    return this.#noted.rows;
  }

  /** Notes that all splats of this many source rows have been added. Rejects as `add`. */
  async keep(rows: number): Promise<void> {
    checkKind('rows', rows, 'a whole number');
    if (!this.#journal) return;
    await this.#queue.drain();
    const { slices, splats } = this.#noted;
    const told = [...this.#told].map((each) => each ?? null);
    const sample = this.#sample.valuesFrom(splats);
    const entry = { rows, runs: this.#runs.slice(slices), bounds: this.#bounds.slice(slices), told, sample };
    this.#noted = { slices: this.#runs.length, rows, splats: this.#count };
    await this.#journal.note({ kind: 'arrived', ...entry });
  }

  /** Notes about losses of the format, complete once the file is written: see `WriteOptions.onNote`. */
  get notes(): readonly string[] {
    return this.#lowest?.meter.notes(ADVICE) ?? [];
  }

  /** Upper bound of the bytes of temporary files for a scene. @param degree degree of its harmonics. */
  temporaryBytes(splatCount: number, degree: ShDegree): number {
    return temporaryBytes(splatCount, degree);
  }

  /**
   * Adds splats. Their memory may be reused once the promise resolves.
   *
   * Rejects with InvalidArgumentError if the set is malformed, not finite or moves, or if `run` returns a
   * wrong result, which a later call may report. Rejects with the signal's reason, and as the
   * storage does.
   */
  async add(set: SplatSet<Harmonics>): Promise<void> {
    checkStill(givenSet(set), '.bricks');
    const file = await this.#openArrived();
    if (set.count > 0) this.#told.add(set.isAntialiased);
    this.#sample.addAll(set.positions, set.count, set.origin, this.#count, set.logScales);
    for (let from = 0; from < set.count; from += SLICE_SPLATS) {
      this.#signal?.throwIfAborted();
      const slice = sliceOf(set, from, Math.min(set.count, from + SLICE_SPLATS));
      const number = this.#slices++;
      this.#count += slice.count;
      await this.#queue.start({ kind: 'records', set: slice }, async ({ run, words, bounds }) => {
        const at = this.#arrivedBytes;
        this.#arrivedBytes += words.byteLength;
        const bytes = bytesOf(words);
        this.#runs[number] = { run, at, sum: sumOf(bytes) };
        this.#bounds[number] = bounds;
        await file.write(bytes, at);
      });
    }
  }

  /**
   * Writes the file. `put` takes the bytes in order.
   *
   * Rejects with InvalidArgumentError 'set' if there are no splats, or if an argument is invalid;
   * and as `add` and `put` do.
   */
  async finish(put: PutBytes, onProgress?: WriteOptions['onProgress']): Promise<void> {
    checkKind('put', put, 'a function');
    checkKind('onProgress', onProgress, 'a function?');
    this.#progress = guarded(onProgress) ?? (() => {});
    await this.#queue.drain();
    if (this.#count === 0)
      throw new InvalidArgumentError('set', 'There are no splats to divide into bricks.');
    const { facts, bounds } = this.#facts();
    const shape = new BrickShape(facts.splatCount);
    this.#lowest ??= await this.#newLowest();
    const levels = [this.#lowest.level];
    const samples = await this.#makeSplats(this.#lowest);
    for (let level = 1; level < shape.cellCounts.length; level++) {
      levels.push(await this.#newLevel(shape, level, facts));
      await this.#makeBlobs(shape, levels, facts);
      this.#report('splats', 'blobs', level, shape.cellCounts.length - 1);
    }
    const axes = [0, 1, 2].map((axis) => samples.filter((_, i) => i % 3 === axis));
    const about = {
      ...{ splatCount: facts.splatCount, shDegree: facts.degree, origin: facts.origin, bounds },
      robustBounds: robustBounds(axes, facts.origin),
      isAntialiased: this.isAntialiased,
    };
    const offsets = offsetsOf(shape, levels);
    const root = { number: 0, offset: offsets[0], bytes: offsets[1] - offsets[0] };
    await put(writeFileHeader({ ...about, root }));
    for (let level = levels.length - 1; level >= 0; level--)
      await this.#putLevel(shape, levels, level, offsets, put);
  }

  /** Removes the temporary files. */
  async end(): Promise<void> {
    await this.#queue.end();
    await Promise.all([...this.#files].map((file) => this.#remove(file)));
  }

  async #openArrived(): Promise<TemporaryFile> {
    this.#arrived ??= await this.#newFile(undefined, 'arrived');
    return this.#arrived;
  }

  async #newFile(byteCount: number | undefined, name?: string): Promise<TemporaryFile> {
    const made = await this.#makeFile(byteCount, name);
    const file = given(made, { write: 'a function', read: 'a function', remove: 'a function' }, 'makeFile');
    this.#files.add(file);
    return file;
  }

  async #remove(file: TemporaryFile): Promise<void> {
    this.#files.delete(file);
    await file.remove();
  }

  #report(from: keyof typeof PROGRESS | 0, to: keyof typeof PROGRESS, done: number, total: number): void {
    const start = from === 0 ? 0 : PROGRESS[from];
    this.#progress(start + (PROGRESS[to] - start) * (done / total));
  }

  #facts(): { readonly facts: SceneFacts; readonly bounds: Bounds } {
    const runs = this.#runs.map(({ run }) => run);
    const total = emptyBounds();
    for (const [i, { origin }] of runs.entries()) {
      for (let axis = 0; axis < 3; axis++) {
        total.min[axis] = Math.min(total.min[axis], this.#bounds[i].min[axis] + origin[axis]);
        total.max[axis] = Math.max(total.max[axis], this.#bounds[i].max[axis] + origin[axis]);
      }
    }
    const [first] = runs;
    const isOne = runs.every(({ origin }) => origin.every((value, axis) => value === first.origin[axis]));
    const origin = isOne ? first.origin : chooseOrigin(this.#sample.axes, total, true);
    const own = emptyBounds();
    for (const [i, run] of runs.entries()) {
      for (let axis = 0; axis < 3; axis++) {
        const moved = (value: number) => movedCoordinate(value, run.origin[axis], origin[axis]);
        own.min[axis] = Math.min(own.min[axis], moved(this.#bounds[i].min[axis]));
        own.max[axis] = Math.max(own.max[axis], moved(this.#bounds[i].max[axis]));
      }
    }
    const reach: number[] = [];
    for (const { harmonics } of runs)
      for (const [band, value] of (harmonics.bandReach ?? []).entries())
        reach[band] = Math.max(reach[band] ?? 0, value);
    const inScene = (corner: Vec3): Vec3 => [
      corner[0] + origin[0],
      corner[1] + origin[1],
      corner[2] + origin[2],
    ];
    return {
      facts: {
        origin,
        degree: trueShDegree(reach),
        frame: cloudFrame(about(this.#sample.axes, origin), own),
        splatCount: this.#count,
        medianSize: this.#sample.medianSize,
      },
      bounds: { min: inScene(own.min), max: inScene(own.max) },
    };
  }

  async #newLevel(shape: BrickShape, level: number, facts: SceneFacts): Promise<WrittenLevel> {
    const cells = shape.cellCounts[level];
    const isTop = level === shape.cellCounts.length - 1;
    const columns = this.#columnsOf(cells);
    return {
      bricks: await this.#newFile(undefined, `bricks-${level}`),
      stored: [],
      byteCount: 0,
      rootsSum: 0,
      roots: await this.#newFile(isTop ? 0 : 4 * cells * CELL_ROOTS * blobWords(facts), `roots-${level}`),
      ...columns,
    };
  }

  #columnsOf(cells: number): Pick<WrittenLevel, 'bounds' | 'largestScales' | 'errors' | 'sizes'> {
    try {
      return {
        bounds: new Float32Array(BOUNDS_WORDS * cells),
        largestScales: new Float32Array(cells),
        errors: new Uint16Array(cells),
        sizes: new Uint32Array(2 * Math.ceil(cells / CELL_CHILDREN)),
      };
    } catch (error) {
      if (!(error instanceof RangeError)) throw error;
      const [argument, advice] =
        this.#noted.splats > 0
          ? ['journal', 'If it is not that of this scene, write the scene without it']
          : ['set', 'Write the scene in parts'];
      const found = `There are ${this.#count} splats, and no memory for the facts about their bricks`;
      throw new InvalidArgumentError(argument, `${found}. ${advice}.`);
    }
  }

  async #newLowest(): Promise<LowestLevel> {
    const { facts } = this.#facts();
    const level = await this.#newLevel(new BrickShape(facts.splatCount), 0, facts);
    const meter = new RoundingMeter(facts.medianSize);
    return { facts, level, seams: new Seams(facts), whole: new Map(), samples: [], meter, madeCells: 0 };
  }

  /** Makes the bricks of the lowest level. Resolves with the positions sampled for robust bounds. */
  async #makeSplats(lowest: LowestLevel): Promise<Float32Array> {
    const { facts, level, whole, samples } = lowest;
    const step = boundsStep(facts.splatCount);
    const makeBricks = (parts: readonly Records[], first: number, range: MadeEntry['range']) =>
      this.#queue.start({ kind: 'splats', parts, facts, first, boundsStep: step }, async (result) => {
        const { bytes, roots, ...made } = result;
        const at = level.byteCount;
        const stored = { made, at, byteCount: bytes.length, sum: sumOf(bytes) };
        level.byteCount += bytes.length;
        await this.#write(level, made.first / CHUNK_SPLATS, at, result, facts);
        await this.#journal?.note({ kind: 'made', range, ...stored });
        this.#takeSplats(lowest, stored);
        this.#report('divided', 'splats', lowest.madeCells, level.errors.length);
      });
    const makeSeams = async () => {
      for (const [first, records] of whole) {
        whole.delete(first);
        await makeBricks([records], first, null);
      }
    };
    const arrived = { runs: this.#runs, open: () => this.#openArrived() };
    await this.#divide(arrived, facts, 0, 0, async (parts, first) => {
      const count = parts.reduce((sum, { run }) => sum + run.count, 0);
      const started = await makeBricks(parts, first, { first, count });
      await makeSeams();
      return started;
    });
    await this.#queue.drain();
    await makeSeams();
    await this.#queue.drain();
    const all = new Float32Array(samples.reduce((sum, { length }) => sum + length, 0));
    let at = 0;
    for (const part of samples) {
      all.set(part, at);
      at += part.length;
    }
    return all;
  }

  /**
   * Divides records into buckets that fit into memory, and passes the buckets on.
   *
   * @param depth number of Morton digits by which they are already divided.
   * @param first index of the first splat in storage order.
   * @returns tasks that `take` started.
   */
  async #divide(
    source: StoredRecords,
    facts: SceneFacts,
    depth: number,
    first: number,
    take: (parts: readonly Records[], first: number) => Promise<StartedTask>,
  ): Promise<readonly StartedTask[]> {
    const count = countOf(source.runs);
    if (this.#made.hold(first, count)) return [];
    const mostSplats = this.#mostSplats(facts);
    if (count <= mostSplats) return [await take(await this.#read(source), first)];
    const started: StartedTask[] = [];
    if (depth === MORTON_SHIFTS.length) {
      // The records have equal Morton codes, and are already in order.
      let next = first;
      for (const runs of batchesOf(source.runs, mostSplats)) {
        const size = countOf(runs);
        if (!this.#made.hold(next, size))
          started.push(await take(await this.#read({ ...source, runs }), next));
        next += size;
      }
      return started;
    }
    const name = bucketsName(depth, first);
    const file = await this.#newFile(4 * recordWords(facts.degree) * count, name);
    let sizes = this.#divided.get(name);
    let sums: readonly number[] | undefined;
    if (!sizes) {
      ({ sizes, sums } = await this.#split(source, facts, depth, file));
      await this.#journal?.note({ kind: 'divided', depth, first, sizes });
    }
    if (depth === 0) await this.#remove(await source.open());
    let start = 0;
    const parts = sizes.map((size, bucket) => {
      const at = 4 * recordWords(facts.degree) * start;
      const part = { run: runOf(size, facts), at, first: first + start, sum: sums?.[bucket] };
      start += size;
      return part;
    });
    // Several in parallel: a bucket that is divided again keeps few threads busy.
    const lanes = depth === 0 ? Math.ceil(this.#threads / 2) : 1;
    const open = async () => file;
    await inLanes(lanes, parts, async ({ first: own, ...run }) => {
      for (const each of await this.#divide({ open, runs: [run] }, facts, depth + 1, own, take))
        started.push(each);
    });
    // A resumed writer still needs records whose bricks are not in the journal.
    if (this.#journal) await this.#queue.drain(started);
    await this.#remove(file);
    return started;
  }

  /**
   * Writes records to `file`, bucket by bucket. Resolves with the count and the checksum of each
   * bucket.
   */
  async #split(
    source: StoredRecords,
    facts: SceneFacts,
    depth: number,
    file: TemporaryFile,
  ): Promise<{ readonly sizes: readonly number[]; readonly sums: readonly number[] }> {
    const count = countOf(source.runs);
    const shift = MORTON_SHIFTS[depth];
    const counts = new Uint32Array(MORTON_DIGITS);
    let done = 0;
    const counting: StartedTask[] = [];
    for (const runs of batchesOf(source.runs, TASK_SPLATS)) {
      const parts = await this.#read({ ...source, runs });
      const started = await this.#queue.start({ kind: 'count', parts, facts, shift }, async (found) => {
        for (let digit = 0; digit < counts.length; digit++) counts[digit] += found[digit];
        done += countOf(runs);
        if (depth === 0) this.#report(0, 'counted', done, count);
      });
      counting.push(started);
    }
    await this.#queue.drain(counting);
    const { buckets, sizes } = bucketsOf(counts, this.#mostSplats(facts));
    const sums = sizes.map(() => 0);
    const next = new Float64Array(sizes.length);
    for (let i = 1; i < sizes.length; i++)
      next[i] = next[i - 1] + 4 * recordWords(facts.degree) * sizes[i - 1];
    // Tasks write in the order of their start, so that the records of a bucket keep their order.
    const waiting = new Map<number, BrickResult<DivideTask>>();
    let [begun, placed] = [0, 0];
    done = 0;
    const dividing: StartedTask[] = [];
    for (const runs of batchesOf(source.runs, TASK_SPLATS)) {
      const parts = await this.#read({ ...source, runs });
      const number = begun++;
      const task = { kind: 'divide', parts, facts, shift, buckets, bucketCount: sizes.length } as const;
      const started = await this.#queue.start(task, async (result) => {
        waiting.set(number, result);
        const writes: Promise<void>[] = [];
        for (let ready = waiting.get(placed); ready; ready = waiting.get(placed)) {
          waiting.delete(placed++);
          let from = 0;
          for (const [bucket, own] of ready.counts.entries()) {
            if (own === 0) continue;
            const bytes = bytesOf(ready.words).subarray(from, from + 4 * recordWords(facts.degree) * own);
            sums[bucket] = (sums[bucket] + sumOf(bytes)) | 0;
            writes.push(file.write(bytes, next[bucket]));
            from += bytes.length;
            next[bucket] += bytes.length;
          }
        }
        await Promise.all(writes);
        done += countOf(runs);
        if (depth === 0) this.#report('counted', 'divided', done, count);
      });
      dividing.push(started);
    }
    await this.#queue.drain(dividing);
    return { sizes, sums };
  }

  #mostSplats({ splatCount }: SceneFacts): number {
    // The size must not depend on the thread count: a resumed writer continues with the same buckets.
    if (this.#threads === 1 || this.#journal) return this.#bucketSplats;
    const share = Math.ceil(splatCount / (THREAD_BUCKETS * this.#threads));
    return Math.min(this.#bucketSplats, Math.max(BRICK_LEAVES, share));
  }

  async #read({ open, runs }: StoredRecords): Promise<Records[]> {
    this.#signal?.throwIfAborted();
    const file = await open();
    return Promise.all(
      runs.map(async ({ run, at, sum }) => {
        const bytes = await readBack(file, at, 4 * run.words * run.count, sum);
        return { run, words: new Uint32Array(bytes.buffer) };
      }),
    );
  }

  /** Appends bricks to the file of a level, and the roots of their cells to another. */
  async #write(
    level: WrittenLevel,
    firstCell: number,
    at: number,
    made: Pick<BricksMade, 'bytes' | 'roots'>,
    facts: SceneFacts,
  ): Promise<void> {
    if (made.bytes.length === 0) return;
    const { bricks, roots, errors } = level;
    const writes = [bricks.write(made.bytes, at)];
    if (errors.length > 1) {
      const { geometry, harmonics } = made.roots;
      const places = 4 * CELL_ROOTS * errors.length * BLOB_WORDS;
      const each = 4 * CELL_ROOTS * (blobWords(facts) - BLOB_WORDS);
      writes.push(roots.write(bytesOf(geometry), 4 * CELL_ROOTS * BLOB_WORDS * firstCell));
      if (each > 0) writes.push(roots.write(bytesOf(harmonics), places + each * firstCell));
      for (const words of each > 0 ? [geometry, harmonics] : [geometry])
        if (level.rootsSum !== undefined) level.rootsSum = (level.rootsSum + sumOf(bytesOf(words))) | 0;
    }
    await Promise.all(writes);
  }

  /** Adds the sizes and bounds of finished bricks to the lowest level. */
  #takeSplats(lowest: LowestLevel, { made, at, byteCount, sum }: StoredSplats): void {
    const { level, seams, samples, whole } = lowest;
    for (const fragment of made.fragments) {
      const seam = seams.add(fragment);
      if (seam) whole.set(seam.first, seam.records);
    }
    samples.push(made.samples);
    addRounding(lowest.meter.rounding, made.rounding);
    lowest.madeCells += made.errors.length;
    level.byteCount = Math.max(level.byteCount, at + byteCount);
    takeMade(level, made.first / CHUNK_SPLATS, made, { at, byteCount, sum });
  }

  /** Makes the bricks of the last of these levels from the roots of the level below. */
  async #makeBlobs(shape: BrickShape, levels: readonly WrittenLevel[], facts: SceneFacts): Promise<void> {
    const level = levels.length - 1;
    const [below, own] = [levels[level - 1], levels[level]];
    const belowCells = below.errors.length;
    let rootsSum = 0;
    for (let first = 0; first < own.errors.length; first += TASK_BRICKS * CELL_CHILDREN) {
      const end = Math.min(own.errors.length, first + TASK_BRICKS * CELL_CHILDREN);
      const [firstBelow, endBelow] = [first * CELL_CHILDREN, Math.min(belowCells, end * CELL_CHILDREN)];
      const bounds = new Float32Array(BOUNDS_WORDS * (end - first));
      for (let cell = firstBelow; cell < endBelow; cell++) {
        const to = Math.floor(cell / CELL_CHILDREN);
        widen(below.bounds, cell, bounds, to - first, cell % CELL_CHILDREN === 0);
        own.largestScales[to] = Math.max(own.largestScales[to], below.largestScales[cell]);
      }
      const rootsOf = async (start: number, words: number) => {
        const each = 4 * CELL_ROOTS * words;
        const byteCount = each * (endBelow - firstBelow);
        if (byteCount === 0) return new Uint32Array(0);
        const found = await readBack(below.roots, start + each * firstBelow, byteCount, undefined);
        rootsSum = (rootsSum + sumOf(found)) | 0;
        // Each cell has room for all leaves.
        const leaves = new Uint32Array((end - first) * CHUNK_SPLATS * words);
        leaves.set(new Uint32Array(found.buffer));
        return leaves;
      };
      const shWords = blobWords(facts) - BLOB_WORDS;
      const leaves = {
        geometry: await rootsOf(0, BLOB_WORDS),
        harmonics: await rootsOf(4 * CELL_ROOTS * BLOB_WORDS * belowCells, shWords),
      };
      const childErrors = below.errors.slice(firstBelow, endBelow);
      const lastLeaves = shape.leavesOf(level, end - 1);
      const { degree } = facts;
      const task = { kind: 'blobs', level, degree, leaves, lastLeaves, bounds, childErrors } as const;
      await this.#queue.start(task, async (made) => {
        const largestScales = own.largestScales.slice(first, end);
        const { length } = made.bytes;
        const at = own.byteCount;
        own.byteCount += length;
        takeMade(own, first, { ...made, largestScales }, { at, byteCount: length, sum: sumOf(made.bytes) });
        await this.#write(own, first, at, made, facts);
      });
    }
    await this.#queue.drain();
    if (below.rootsSum !== undefined && below.rootsSum !== rootsSum)
      throw wrongStorage('the roots of a level are not those that were written');
  }

  async #putLevel(
    shape: BrickShape,
    levels: readonly WrittenLevel[],
    level: number,
    offsets: Float64Array,
    put: PutBytes,
  ): Promise<void> {
    const { bricks, stored, sizes } = levels[level];
    const firstNumber = level === levels.length - 1 ? 0 : shape.childOf(level + 1, 0);
    const addressOf = (number: number) => {
      return { number, offset: offsets[number], bytes: offsets[number + 1] - offsets[number] };
    };
    stored.sort((a, b) => a.firstBrick - b.firstBrick);
    for (const { firstBrick, count, at, byteCount, sum } of stored) {
      this.#signal?.throwIfAborted();
      const payload = await readBack(bricks, at, byteCount, sum);
      const start = offsets[firstNumber + firstBrick];
      const file = new Uint8Array(offsets[firstNumber + firstBrick + count] - start);
      let from = 0;
      for (let brick = firstBrick; brick < firstBrick + count; brick++) {
        const number = firstNumber + brick;
        const [geometryBytes, harmonicsBytes] = sizes.subarray(2 * brick, 2 * brick + 2);
        const { first, end } = shape.cellsOf(number);
        const cells = [];
        for (let cell = first; cell < end; cell++) cells.push(cellOf(shape, levels, level, cell));
        const header = writeBrickHeader(
          { level, cells },
          number,
          { geometryBytes, harmonicsBytes },
          addressOf,
        );
        const to = offsets[number] - start;
        const length = geometryBytes + harmonicsBytes;
        file.set(header, to);
        file.set(payload.subarray(from, from + length), to + header.length);
        from += length;
      }
      await put(file);
      this.#report('blobs', 'written', offsets[firstNumber + firstBrick + count], offsets[shape.brickCount]);
    }
  }
}

/** @throws InvalidArgumentError if bricks from a journal lie outside of the scene's range of bricks. */
function checkPlaces(
  { first, errors, fragments }: StoredSplats['made'],
  { facts, level }: LowestLevel,
): void {
  const cells = first / CHUNK_SPLATS + errors.length;
  if (errors.length > 0 && !(first % BRICK_LEAVES === 0 && cells <= level.errors.length))
    throw wrongArgument('entry.made.first', first, `that of a brick of ${facts.splatCount} splats`);
  for (const fragment of fragments) {
    const splats = fragment.words.length / recordWords(facts.degree);
    const end = Math.floor(fragment.first / BRICK_LEAVES) * BRICK_LEAVES + BRICK_LEAVES;
    if (!(Number.isInteger(splats) && fragment.first + splats <= Math.min(end, facts.splatCount)))
      throw wrongArgument('entry.made.fragments', fragment.first, `the first of splats of one brick`);
  }
}

/** Copies the sizes, bounds and scales of finished bricks into the arrays of their level. */
function takeMade(
  level: WrittenLevel,
  firstCell: number,
  made: Omit<BricksMade, 'bytes' | 'roots'>,
  stored: Pick<StoredBricks, 'at' | 'byteCount' | 'sum'>,
): void {
  if (made.errors.length === 0) return;
  const firstBrick = firstCell / CELL_CHILDREN;
  level.stored.push({ firstBrick, count: made.sizes.length / 2, ...stored });
  level.sizes.set(made.sizes, 2 * firstBrick);
  level.bounds.set(made.bounds, BOUNDS_WORDS * firstCell);
  level.largestScales.set(made.largestScales, firstCell);
  level.errors.set(made.errors, firstCell);
}

function blobWords({ degree }: SceneFacts): number {
  return BLOB_WORDS + shWordsPerSplat(degree, BLOB_PRECISION.shPrecision);
}

/** Extends the bounds of cell `to` by the bounds of cell `from`. */
function widen(source: Float32Array, from: number, target: Float32Array, to: number, isFirst: boolean): void {
  for (let k = 0; k < BOUNDS_WORDS; k++) {
    const value = source[BOUNDS_WORDS * from + k];
    const at = BOUNDS_WORDS * to + k;
    const wider = k < 3 ? Math.min : Math.max;
    target[at] = isFirst ? value : wider(target[at], value);
  }
}

/** Byte offset of each brick in the file, then the end of the last brick. */
function offsetsOf(shape: BrickShape, levels: readonly WrittenLevel[]): Float64Array {
  const offsets = new Float64Array(shape.brickCount + 1);
  offsets[0] = FILE_HEADER_BYTES;
  for (let number = 0; number < shape.brickCount; number++) {
    const { level, first, end } = shape.cellsOf(number);
    const [geometry, harmonics] = levels[level].sizes.subarray((2 * first) / CELL_CHILDREN);
    offsets[number + 1] = offsets[number] + brickHeaderBytes(level, end - first) + geometry + harmonics;
  }
  return offsets;
}

/** The header fields of a cell. */
function cellOf(shape: BrickShape, levels: readonly WrittenLevel[], level: number, cell: number) {
  const { bounds, largestScales } = levels[level];
  const [minX, minY, minZ, maxX, maxY, maxZ] = bounds.subarray(BOUNDS_WORDS * cell);
  const own = {
    bounds: { min: [minX, minY, minZ], max: [maxX, maxY, maxZ] },
    largestScale: largestScales[cell],
  } as const;
  if (level === 0) return { ...own, child: null, childErrors: [] };
  const { errors } = levels[level - 1];
  return {
    ...own,
    child: { number: shape.childOf(level, cell) },
    childErrors: errors.subarray(CELL_CHILDREN * cell, CELL_CHILDREN * (cell + 1)),
  };
}

/** Coordinates relative to an origin, as they are stored. */
function about(axes: readonly Float64Array[], origin: Vec3): Float32Array[] {
  return axes.map((values, axis) => Float32Array.from(values, (value) => value - origin[axis]));
}

function bytesOf({ buffer, byteOffset, byteLength }: Uint32Array<ArrayBuffer>): Uint8Array<ArrayBuffer> {
  return new Uint8Array(buffer, byteOffset, byteLength);
}
