import { DestroyedError } from '../../data/errors.ts';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { roundUp } from '../../data/layout/gpu-struct.ts';
import { INGEST_FACTS } from '../../data/layout/ingest-facts.ts';
import { IngestParameters } from '../../data/layout/packing-structs.ts';
import { Chunk } from '../../data/layout/structs.ts';
import type { Vec3 } from '../../data/math/mat4.ts';
import { chunkCountOf } from '../../data/packing/chunks.ts';
import { cloudFrame } from '../../data/packing/morton-order.ts';
import { chooseOrigin } from '../../data/packing/origin.ts';
import { robustBounds, totalBounds } from '../../data/packing/packed-cloud.ts';
import { type CloudPrecision, ownShPrecision, type RowPrecision } from '../../data/packing/precision.ts';
import { paletteValues, type RowLayout } from '../../data/packing/row-layout.ts';
import { coefficientsPerSplat, type FileFacts, type ShDegree } from '../../data/splats/splat-set.ts';
import { nextTask } from '../../data/turns.ts';
import type { Guarded } from '../../gpu/gpu-memory.ts';
import type { StageDefinition } from '../../gpu/pipelines.ts';
import { probeMemory } from '../../gpu/probe-memory.ts';
import { readWords } from '../../gpu/read-buffer.ts';
import type { RowSink } from '../../io/formats/rows/row-sink.ts';
import { emptyError } from '../../io/formats/rows/splat-counts.ts';
import { ingestRows, pieceParameters } from '../../stages/ingest/ingest.ts';
import {
  CloudPlanes,
  type MadePlanes,
  type PageRange,
  type Plane,
  pagesOf,
  planeOf,
} from '../cloud-planes.ts';
import { createGeometry, createHarmonics } from '../create-plane.ts';
import { type CloudFit, cloudBytes, type FitMode, type FitSettings, fitSettings } from '../fit-settings.ts';
import { type CloudContents, MEMORY_ADVICE, type SplatCloud } from '../splat-cloud.ts';
import { arrangePlanes, arrangeStages, isRoomy } from './arrange-planes.ts';
import { Arrivals } from './arrivals.ts';
import { type DispatchContext, Dispatches } from './dispatches.ts';
import { readChunks } from './read-chunks.ts';
import { type RowFacts, readRowFacts } from './row-facts.ts';
import { sampleCentres, samplePositions } from './sample-centres.ts';

/** Staging buffers: pieces being written, or copied by the GPU. */
const STAGING_BUFFERS = 4;
/** Loads of fewer bytes skip the memory probe, because allocations are checked anyway. */
const PROBED_BYTES = 64 << 20;
const NOT_MOVED: Vec3 = [0, 0, 0];
/** Peak bytes per splat of arranging, besides the planes. */
const ARRANGE_BYTES = 16;
/** Pieces that may wait for shaders to compile, so that reading goes on. */
const MOST_WAITING = 16;

export interface RowIngestOptions extends CloudPrecision {
  /** For labels and messages. */
  readonly name: string;
  /** See `LoadOptions`. */
  readonly onPreview?: (preview: SplatCloud) => void;
  /**
   * Pages for the planes, used if they hold as many splats as were kept. Default: derived from the
   * file.
   */
  readonly pages?: readonly PageRange[];
  readonly signal: AbortSignal;
  /** Behaviour if memory is lacking. Default: `exact`. */
  readonly fit?: FitMode;
}

/** A cloud made from the rows of a file. */
export interface IngestedCloud {
  readonly contents: CloudContents;
  readonly planes: CloudPlanes;
  /** Shares the planes and lives as long as they do; null without `onPreview`. */
  readonly preview: SplatCloud | null;
  /** Coarser settings that were used because memory was lacking for the wanted ones; else null. */
  readonly fit: CloudFit | null;
}

/** Buffers for the rows of one file and for its planes. */
interface Held {
  readonly layout: RowLayout;
  readonly stage: StageDefinition;
  readonly ranges: readonly PageRange[];
  readonly geometry: Plane;
  /** Empty at degree 0. */
  readonly harmonics: Plane;
  readonly dropMask: GPUBuffer;
  readonly facts: GPUBuffer;
  /** One `Chunk` struct per 256 slots. */
  readonly chunks: GPUBuffer;
  /** Fractions of packed log scales between two steps; null if log scales are float32. */
  readonly logScaleRests: GPUBuffer | null;
  /** One piece of the file. */
  readonly rows: GPUBuffer;
  /** Null if rows have harmonics of their own. */
  readonly palette: GPUBuffer | null;
}

/** Statistics of all rows, after the last has arrived. */
interface FoundRows extends RowFacts {
  /** Positions of sampled rows: see `samplePositions`. */
  readonly sample: readonly Float32Array[];
}

/** Rows in staging memory. */
interface Piece {
  readonly staging: GPUBuffer;
  readonly firstRow: number;
  readonly rowCount: number;
}

/**
 * Makes a cloud from the rows of a file on the GPU. Rows are packed as they arrive, through a few
 * staging buffers and one copy; `finish` puts them into storage order.
 *
 * Call `finish` after the last row, or `destroy`.
 */
export class RowIngest implements RowSink {
  /** Mapped memory cannot be detached. */
  readonly mayDetach = false;
  readonly #context: DispatchContext;
  #options: RowIngestOptions & RowPrecision;
  #fit: CloudFit | null = null;
  /** Null without `onPreview`. */
  #arrivals: Arrivals | null = null;
  readonly #staging: GPUBuffer[] = [];
  /** Staging buffers that are mapped or being mapped. */
  readonly #free: Promise<GPUBuffer>[] = [];
  readonly #buffers = new Set<GPUBuffer>();
  #held: Held | null = null;
  #current: GPUBuffer | null = null;
  #rowsTaken = 0;
  #paletteValuesTaken = 0;
  /** Notes on all rows together: see `RowSink`. */
  readonly #notes: string[] = [];
  /** Settles once rows can be packed and `#waiting` has been submitted. */
  #compiled: Promise<void> = Promise.resolve();
  /** Each rejects if memory was lacking for an allocation. */
  readonly #checks: (Promise<void> | null)[] = [];
  /** Pieces that wait for shaders; null once the shaders are compiled. */
  #waiting: Piece[] | null = [];
  #isDestroyed = false;

  constructor(context: DispatchContext, options: RowIngestOptions) {
    this.#context = context;
    this.#options = asRows(options);
  }

  /** @throws GpuLimitError; the signal's reason; DestroyedError. Nothing is left allocated then. */
  async begin(rows: RowLayout): Promise<void> {
    const layout = await this.#fitted(rows);
    this.#live();
    const { device, memory, pipelines } = this.#context;
    const { geometryPrecision, shPrecision, name, onPreview } = this.#options;
    const { count, shDegree, strideBytes, pieceRows, palette, byteHarmonics } = layout;
    const precision = { geometryPrecision, shPrecision };
    const entryValues = palette?.entryValues;
    const hasByteHarmonics = byteHarmonics !== undefined;
    const stage = ingestRows({ ...precision, shDegree, entryValues, hasByteHarmonics });
    const compiled = pipelines.prepare([stage]);
    // Pipelines of `finish` compile while rows arrive.
    pipelines.prepare(lateStages(this.#options)).catch(() => {});
    const { STORAGE, COPY_DST, COPY_SRC, MAP_WRITE } = GPUBufferUsage;
    try {
      const { checked } = this.#allocate(() => {
        const ranges = pagesOf(device.limits, count, shDegree, name);
        const place = { memory, name, ranges };
        const keep = <Made extends GPUBuffer | Plane>(made: Made): Made => {
          for (const buffer of [made].flat()) this.#buffers.add(buffer as GPUBuffer);
          return made;
        };
        const create = (label: string, bytes: number, usage: GPUBufferUsageFlags = 0) =>
          keep(memory.createBuffer(`ingest ${label}`, bytes, STORAGE | usage));
        const pieceBytes = roundUp(Math.min(count, pieceRows) * strideBytes, 4);
        const geometry = keep(createGeometry(place, geometryPrecision));
        const harmonics = keep(createHarmonics(place, shDegree, shPrecision));
        const facts = create('facts', 4 * INGEST_FACTS.FACTS, COPY_SRC);
        const chunks = create('chunks', Chunk.bytes * chunkCountOf(count), COPY_SRC);
        const paletteBytes = 4 * paletteValues(layout);
        if (onPreview) {
          const shown = planeOf(place, ({ start, end }, page) =>
            create(`arrived chunks ${page}`, Chunk.bytes * chunkCountOf(end - start), COPY_DST),
          );
          const shared = { geometry, harmonics, facts, chunks: shown, arrivedChunks: chunks };
          const planes = { ...precision, shDegree, ranges, ...shared, origin: layout.origin ?? NOT_MOVED };
          this.#arrivals = new Arrivals(this.#context, planes, name, onPreview);
        }
        this.#held = {
          layout,
          stage,
          ranges,
          geometry,
          harmonics,
          dropMask: create('drop mask', roundUp(count, CHUNK_SPLATS) / 8, COPY_SRC),
          facts,
          chunks,
          logScaleRests: geometryPrecision === 'packed' ? create('log scale rests', 4 * count) : null,
          // A value between two words is read from both.
          rows: create('rows', pieceBytes + 4, COPY_DST),
          palette: paletteBytes > 0 ? create('palette', paletteBytes, COPY_DST) : null,
        };
        // Mapped at creation, because mapping later may wait for the GPU process to compile
        // shaders.
        const usage = MAP_WRITE | COPY_SRC;
        const stagingCount = stagingCountOf(layout);
        for (let i = 0; i < stagingCount; i++) {
          const staging = keep(memory.createBuffer(`ingest staging ${i}`, pieceBytes, usage, true));
          this.#staging.push(staging);
          this.#free.push(Promise.resolve(staging));
        }
      });
      await checked;
    } catch (error) {
      // The lack of memory is thrown instead.
      compiled.catch(() => {});
      this.destroy();
      throw error;
    }
    // Rows may arrive before the shaders are compiled.
    this.#compiled = compiled.then(() => {
      this.#live();
      const waiting = this.#waiting ?? [];
      this.#waiting = null;
      for (const piece of waiting) this.#submit(piece);
    });
    // `finish` awaits it.
    this.#compiled.catch(() => {});
  }

  /**
   * Chooses coarser settings if memory is lacking and `fit` allows them. @returns the layout with
   * the degree to store.
   */
  async #fitted(layout: RowLayout): Promise<RowLayout> {
    const { geometryPrecision, shPrecision, name, signal, fit = 'exact' } = this.#options;
    const { memory } = this.#context;
    const wanted = { geometryPrecision, shPrecision, shDegree: layout.shDegree };
    const bytesOf = (settings: FitSettings) => ingestBytes(layout, settings);
    if (fit === 'exact' && bytesOf(wanted) < PROBED_BYTES && bytesOf(wanted) <= memory.availableBytes)
      return layout;
    this.#fit = await fitSettings({ memory, name, bytesOf, signal }, wanted, fit);
    if (!this.#fit) return layout;
    const { shDegree, ...taken } = this.#fit.taken;
    this.#options = asRows({ ...this.#options, ...taken });
    return { ...layout, shDegree };
  }

  async memory(): Promise<Uint8Array<ArrayBuffer>> {
    this.#live();
    this.#current = this.#free.length === 0 ? this.#stagingForNow() : null;
    if (!this.#current) {
      if (this.#free.length === 0) await this.#compiled;
      this.#current = await this.#free.shift()!;
      this.#live();
    }
    return new Uint8Array(this.#current.getMappedRange());
  }

  take(rowCount: number): void {
    const staging = this.#current!;
    this.#current = null;
    const { layout, palette } = this.#held!;
    if (palette && this.#paletteValuesTaken < paletteValues(layout)) {
      this.#takeValues(staging, palette, rowCount);
      return;
    }
    const piece = { staging, firstRow: this.#rowsTaken, rowCount };
    this.#rowsTaken += rowCount;
    if (this.#waiting) this.#waiting.push(piece);
    else this.#submit(piece);
  }

  note(text: string): void {
    this.#notes.push(text);
  }

  /**
   * Puts the splats into storage order. The caller owns the planes from then on; all other buffers
   * are freed.
   *
   * @throws GpuLimitError; SplatFileError 'empty' if no row was kept. Nothing is left allocated
   *   then.
   */
  async finish(): Promise<IngestedCloud> {
    const { device, memory, pipelines } = this.#context;
    const { name } = this.#options;
    const arrivals = this.#arrivals;
    const arranged: GPUBuffer[] = [];
    try {
      await this.#compiled;
      await Promise.all(this.#checks);
      const { rows, palette } = this.#live();
      for (const buffer of [...this.#staging, rows, palette]) if (buffer) this.#destroy(buffer);
      await pipelines.prepare(lateStages(this.#options));
      this.#live();
      const found = await this.#readFacts();
      arrivals?.stop();
      const hasRoom = await this.#hasRoomFor(found);
      this.#live();
      arrivals?.hold();
      const { result, checked } = this.#allocate(() => {
        const { planes, contents, fileRows } = this.#arrange(found, hasRoom, arranged);
        const reading = [
          this.#readBounds(planes, contents),
          readWords(device, fileRows, found.count),
        ] as const;
        // Awaited only if the allocation succeeded.
        for (const each of reading) each.catch(() => {});
        return { planes, contents, reading };
      });
      await checked;
      const { contents, reading } = result;
      const drawable = { ...contents, ...(await reading[0]) };
      this.#live();
      const planes = new CloudPlanes(memory, name, result.planes);
      const preview = arrivals?.show(planes, drawable) ?? null;
      const whole = { ...drawable, fileIndices: await reading[1] };
      // Copying millions of rows fills one task, so other work goes first.
      await nextTask();
      return { contents: whole, planes, preview, fit: this.#fit };
    } catch (error) {
      arrivals?.end();
      for (const buffer of arranged) memory.destroy(buffer);
      throw error;
    } finally {
      this.#freeBuffers();
    }
  }

  /** Frees everything, and ends the previews. */
  destroy(): void {
    this.#isDestroyed = true;
    this.#arrivals?.end();
    this.#freeBuffers();
  }

  /**
   * Call after each await: destroyed meanwhile, `#held` is gone, and new buffers would never be
   * freed. A load ends by its signal, or by an error of its reader.
   *
   * @throws the signal's reason, DestroyedError.
   */
  #live(): Held {
    const { signal, name } = this.#options;
    signal.throwIfAborted();
    if (this.#isDestroyed) throw new DestroyedError(`The load of ${name}`, 'it has ended');
    return this.#held!;
  }

  #freeBuffers(): void {
    for (const buffer of [...this.#buffers]) this.#destroy(buffer);
    this.#held = null;
  }

  /**
   * Returns memory for another piece that waits for shaders; null if memory is lacking, too many
   * wait, or shaders are compiled.
   */
  #stagingForNow(): GPUBuffer | null {
    const { memory } = this.#context;
    if (!this.#waiting || this.#waiting.length >= MOST_WAITING) return null;
    const { size, usage } = this.#staging[0];
    try {
      const { result, checked } = this.#allocate(() =>
        memory.createBuffer('ingest staging', size, usage, true),
      );
      this.#checks.push(checked);
      this.#buffers.add(result);
      return result;
    } catch {
      // Reading then waits for a free buffer.
      return null;
    }
  }

  /**
   * Runs work that allocates. @returns its result, and a promise that rejects with a GpuLimitError
   * if memory is lacking.
   */
  #allocate<Result>(work: () => Result): Guarded<Result> {
    return this.#context.memory.guard(this.#options.name, MEMORY_ADVICE, work, true);
  }

  #destroy(buffer: GPUBuffer): void {
    if (this.#buffers.delete(buffer)) this.#context.memory.destroy(buffer);
  }

  /** Copies values of the palette, which needs no shader. */
  #takeValues(staging: GPUBuffer, palette: GPUBuffer, count: number): void {
    const { queue } = this.#context.device;
    staging.unmap();
    const encoder = this.#context.device.createCommandEncoder({ label: 'ingest palette' });
    encoder.copyBufferToBuffer(staging, 0, palette, 4 * this.#paletteValuesTaken, 4 * count);
    queue.submit([encoder.finish()]);
    this.#paletteValuesTaken += count;
    this.#reuse(staging);
  }

  /** Maps a staging buffer again; frees it if it was an extra one for a waiting piece. */
  #reuse(staging: GPUBuffer): void {
    if (!this.#staging.includes(staging)) {
      this.#destroy(staging);
      return;
    }
    const free = this.#context.memory.map(staging, GPUMapMode.WRITE).then(() => staging);
    // The device may be lost before the promise is awaited.
    free.catch(() => {});
    this.#free.push(free);
  }

  #submit({ staging, firstRow, rowCount }: Piece): void {
    const { stage, ranges, layout, geometry, harmonics, ...shared } = this.#held!;
    const endRow = firstRow + rowCount;
    staging.unmap();
    const { checked } = this.#allocate(() => {
      const dispatches = new Dispatches(this.#context);
      for (const [page, range] of ranges.entries()) {
        const start = Math.max(firstRow, range.start);
        const rowsOfPage = Math.min(endRow, range.end) - start;
        if (rowsOfPage <= 0) continue;
        const parameters = IngestParameters.pack({
          ...pieceParameters(layout, rowCount),
          firstRow: start - firstRow,
          rowCount: rowsOfPage,
          pageSlot: start - range.start,
          maskRow: start,
          dispatchRow: this.#context.dispatchRow,
        });
        const { rows, palette, dropMask, facts, chunks, logScaleRests } = shared;
        const bindings = {
          rows,
          dropMask,
          facts,
          chunks,
          geometry: geometry[page],
          harmonics: harmonics[page],
          ...(logScaleRests && { logScaleRests }),
          ...(palette && { palette }),
        };
        dispatches.add(stage, parameters, bindings, Math.ceil(rowsOfPage / CHUNK_SPLATS));
      }
      const bytes = roundUp(rowCount * layout.strideBytes, 4);
      dispatches.submit('ingest rows', (encoder) =>
        encoder.copyBufferToBuffer(staging, 0, shared.rows, 0, bytes),
      );
    });
    this.#checks.push(checked);
    this.#reuse(staging);
    this.#arrivals?.add(endRow);
  }

  /** @throws SplatFileError 'empty' if no row was kept. */
  async #readFacts(): Promise<FoundRows> {
    const { device } = this.#context;
    const { geometryPrecision, name } = this.#options;
    const { layout, facts, ranges, geometry, dropMask } = this.#held!;
    const found = readRowFacts(await readWords(device, facts), {
      ...layout,
      fileFacts: this.#fileFacts(layout),
    });
    this.#live();
    if (found.count === 0) throw emptyError(name, found.dropped);
    const { result, checked } = this.#allocate(() => {
      const rows = { count: layout.count, ranges, geometry, geometryPrecision };
      const reading = samplePositions(this.#context, rows, dropMask, found.count);
      // Awaited only if the allocation succeeded.
      reading.catch(() => {});
      return reading;
    });
    await checked;
    const sample = await result;
    this.#live();
    return { ...found, sample };
  }

  #fileFacts({ fileFacts }: RowLayout): FileFacts | undefined {
    if (!fileFacts || this.#notes.length === 0) return fileFacts;
    return { ...fileFacts, notes: [...(fileFacts.notes ?? []), ...this.#notes] };
  }

  /**
   * Whether memory has room for smaller planes besides the current ones; true if none are needed.
   */
  async #hasRoomFor({ count }: RowFacts): Promise<boolean> {
    const { layout } = this.#held!;
    if (!isRoomy(count, layout.count)) return true;
    const planes = cloudBytes(count, { ...this.#options, shDegree: layout.shDegree });
    return probeMemory(this.#context.memory, planes + ARRANGE_BYTES * layout.count);
  }

  /**
   * Puts splats into storage order.
   *
   * @param hasRoom see `ArrivedPlanes`.
   * @param made receives the buffers of the cloud as soon as they exist.
   * @returns planes and contents, without the facts to be read from the GPU.
   */
  #arrange(found: FoundRows, hasRoom: boolean, made: GPUBuffer[]) {
    const { geometryPrecision, shPrecision, name, pages } = this.#options;
    const { ranges, geometry, harmonics, dropMask, chunks, logScaleRests, layout } = this.#held!;
    // Rows with an origin of their own keep it.
    const shift = layout.origin ? NOT_MOVED : chooseOrigin(found.sample, found, false);
    const about = (values: Float32Array, axis: number) =>
      Float32Array.from(values, (value) => value - shift[axis]);
    const axes = found.sample.map(about);
    const [min, max] = [found.min, found.max].map((corner) =>
      Float32Array.from(corner, (value, axis) => value - shift[axis]),
    );
    const { trueShDegree } = found.facts;
    const precision = { geometryPrecision, shPrecision };
    const frame = cloudFrame(axes, { min, max });
    const { fileRows, ...planes } = arrangePlanes(this.#context, {
      ...precision,
      name,
      ranges,
      geometry,
      harmonics,
      dropMask,
      shDegree: layout.shDegree,
      keptShDegree: trueShDegree,
      kept: found.count,
      hasRoom,
      origin: shift,
      frame,
      arrivedChunks: chunks,
      logScaleRests,
      pages: pages?.at(-1)?.end === found.count ? pages : undefined,
    });
    // `arrangePlanes` freed the replaced planes, and the caller owns the rest.
    for (const buffer of [...geometry, ...harmonics]) this.#buffers.delete(buffer);
    made.push(...planes.geometry, ...planes.harmonics, ...planes.chunks);
    this.#buffers.add(fileRows);
    const contents = {
      count: found.count,
      origin: layout.origin ?? shift,
      dropped: found.dropped,
      fileIndices: new Uint32Array(0),
      facts: found.facts,
      precision,
    };
    return { contents, fileRows, planes: { ...planes, ...precision, shDegree: trueShDegree } };
  }

  async #readBounds(planes: MadePlanes, { count, origin }: Pick<CloudContents, 'count' | 'origin'>) {
    const [centres, chunks] = await Promise.all([
      sampleCentres(this.#context, { ...planes, count }),
      readChunks(this.#context.device, planes),
    ]);
    await nextTask();
    return { bounds: totalBounds(chunks, origin), robustBounds: robustBounds(centres, origin), chunks };
  }
}

function stagingCountOf({ count, pieceRows }: RowLayout): number {
  return Math.min(STAGING_BUFFERS, Math.ceil(count / pieceRows));
}

/**
 * Peak bytes of a load: the planes, and the memory for reading or arranging them. Optional memory
 * is not counted: for pieces that wait for shaders, and for smaller planes without dropped slots.
 * New planes for fewer bands or other pages are rare, and are checked when they are made.
 */
function ingestBytes(layout: RowLayout, settings: FitSettings): number {
  const { count, strideBytes, pieceRows } = layout;
  const pieceBytes = Math.min(count, pieceRows) * strideBytes;
  const reading =
    (1 + stagingCountOf(layout)) * pieceBytes +
    4 * paletteValues(layout) +
    (settings.geometryPrecision === 'packed' ? 4 * count : 0);
  const chunkBytes = Chunk.bytes * chunkCountOf(count);
  return cloudBytes(count, settings) + chunkBytes + Math.max(reading, ARRANGE_BYTES * count);
}

/** What the shaders of rows depend on. */
export interface RowKind {
  readonly shDegree: ShDegree;
  /** Whether harmonics are bytes of the file. */
  readonly hasByteHarmonics: boolean;
  /** The palette has the same degree. */
  readonly hasPalette: boolean;
}

/** Stages that make a cloud of rows. */
export function rowStages({ hasPalette, ...wanted }: CloudPrecision & RowKind): StageDefinition[] {
  const variant = asRows(wanted);
  const entryValues = hasPalette ? coefficientsPerSplat(wanted.shDegree) : undefined;
  return [ingestRows({ ...variant, entryValues }), ...lateStages(variant)];
}

/** Rows are packed one by one, so they never get a palette. */
function asRows<Wanted extends CloudPrecision>(wanted: Wanted): Wanted & RowPrecision {
  return { ...wanted, shPrecision: ownShPrecision(wanted.shPrecision) };
}

/** Stages that run after the last row, for loads with and without dropped rows. */
function lateStages({ geometryPrecision }: RowPrecision): StageDefinition[] {
  return [...arrangeStages({ geometryPrecision }, false), ...arrangeStages({ geometryPrecision }, true)];
}
