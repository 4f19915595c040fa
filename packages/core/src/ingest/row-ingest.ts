import { type MadePlanes, type PageRange, type Plane, pagesOf } from '../clouds/cloud-planes.ts';
import { createGeometry, createHarmonics } from '../clouds/create-plane.ts';
import type { CloudContents } from '../clouds/splat-cloud.ts';
import { GpuLimitError } from '../errors.ts';
import type { StageDefinition } from '../gpu/pipelines.ts';
import { readWords } from '../gpu/read-buffer.ts';
import { emptyError } from '../io/empty-error.ts';
import type { RowSink } from '../io/row-sink.ts';
import { CHUNK_SPLATS } from '../layout/constants.ts';
import { roundUp } from '../layout/gpu-struct.ts';
import { INGEST_FACTS } from '../layout/ingest-facts.ts';
import { orderedBits } from '../layout/ordered-bits.ts';
import { IngestParameters, PermuteParameters, SettleParameters } from '../layout/packing-structs.ts';
import { FAINT_LOGIT } from '../packing/cloud-facts.ts';
import { GEOMETRY_WORDS, logScaleRange } from '../packing/geometry.ts';
import { ingestLogScaleSteps } from '../packing/ingest-log-scale.ts';
import { mortonFrame } from '../packing/morton-order.ts';
import { chooseOrigin } from '../packing/origin.ts';
import { boundsSamples, robustBounds, totalBounds } from '../packing/packed-cloud.ts';
import type { CloudPrecision } from '../packing/precision.ts';
import type { RowLayout } from '../packing/row-layout.ts';
import { ingestGather } from '../stages/ingest-gather.ts';
import { ingestRows } from '../stages/ingest-rows.ts';
import { ingestSettle } from '../stages/ingest-settle.ts';
import { type ArrangeContext, type ArrangedPlanes, arrangePlanes, arrangeStages } from './arrange-planes.ts';
import { Dispatches } from './dispatches.ts';
import { type RowFacts, readRowFacts } from './row-facts.ts';

/** Pieces that are written, or being read by the GPU, at once. */
const STAGING_BUFFERS = 3;

export interface RowIngestOptions extends CloudPrecision {
  /** For labels and messages. */
  readonly name: string;
}

/** A cloud that was made from the rows of a file. */
export interface IngestedCloud {
  readonly contents: CloudContents;
  readonly planes: MadePlanes;
}

/** Memory for the rows of one file, and for what is made of them. */
interface Held {
  readonly layout: RowLayout;
  readonly stage: StageDefinition;
  readonly ranges: readonly PageRange[];
  readonly geometry: Plane;
  /** Empty at degree 0. */
  readonly harmonics: Plane;
  readonly dropMask: GPUBuffer;
  readonly facts: GPUBuffer;
  /** The lower bits of log scales; null where they are float32. */
  readonly logScaleRests: GPUBuffer | null;
  /** A piece of the file. */
  readonly rows: GPUBuffer;
  readonly offsets: Uint32Array;
}

/**
 * Makes a cloud of the rows of a file on the GPU: packs them as they arrive, and puts them into storage order at the end. Rows go
 * through a few staging buffers, and are copied once.
 *
 * Call `finish` after the last row, or `destroy`.
 */
export class RowIngest implements RowSink {
  readonly #context: ArrangeContext;
  readonly #options: RowIngestOptions;
  readonly #staging: GPUBuffer[] = [];
  /** Mapped, or about to be. */
  readonly #free: Promise<GPUBuffer>[] = [];
  readonly #buffers = new Set<GPUBuffer>();
  #held: Held | null = null;
  #current: GPUBuffer | null = null;
  #rowsTaken = 0;

  constructor(context: ArrangeContext, options: RowIngestOptions) {
    this.#context = context;
    this.#options = options;
  }

  /** @throws GpuLimitError; nothing is left allocated then. */
  async begin(layout: RowLayout): Promise<void> {
    const { device, memory, pipelines } = this.#context;
    const { geometryPrecision, shPrecision, name } = this.#options;
    const { count, shDegree, strideBytes, pieceRows } = layout;
    const stage = ingestRows({ geometryPrecision, shPrecision, shDegree });
    const compiled = pipelines.prepare([stage]);
    // What is needed only at the end compiles while rows arrive.
    pipelines.prepare(this.#lateStages()).catch(() => {});
    const { STORAGE, COPY_DST, COPY_SRC, MAP_WRITE } = GPUBufferUsage;
    device.pushErrorScope('out-of-memory');
    let lacking: Promise<GPUError | null> | null = null;
    try {
      const ranges = pagesOf(device.limits, count, shDegree, name);
      const place = { memory, name, ranges };
      const keep = <Made extends GPUBuffer | Plane>(made: Made): Made => {
        for (const buffer of [made].flat()) this.#buffers.add(buffer as GPUBuffer);
        return made;
      };
      const create = (label: string, bytes: number, usage: GPUBufferUsageFlags = 0) =>
        keep(memory.createBuffer(`ingest ${label}`, bytes, STORAGE | usage));
      const pieceBytes = roundUp(Math.min(count, pieceRows) * strideBytes, 4);
      const offsets = new Uint32Array(60);
      offsets.set(layout.offsets);
      this.#held = {
        layout,
        stage,
        ranges,
        geometry: keep(createGeometry(place, geometryPrecision)),
        harmonics: keep(createHarmonics(place, shDegree, shPrecision)),
        dropMask: create('drop mask', roundUp(count, CHUNK_SPLATS) / 8),
        facts: create('facts', 4 * INGEST_FACTS.FACTS, COPY_SRC),
        logScaleRests: geometryPrecision === 'packed' ? create('log scale rests', 4 * count) : null,
        // A value that begins between words is read from two of them.
        rows: create('rows', pieceBytes + 4, COPY_DST),
        offsets,
      };
      const stagingCount = Math.min(STAGING_BUFFERS, Math.ceil(count / pieceRows));
      for (let i = 0; i < stagingCount; i++) {
        const staging = keep(memory.createBuffer(`ingest staging ${i}`, pieceBytes, MAP_WRITE | COPY_SRC));
        this.#staging.push(staging);
        this.#free.push(mapped(staging));
      }
      lacking = device.popErrorScope();
      if (await lacking) throw this.#memoryError();
      await compiled;
    } catch (error) {
      if (!lacking) device.popErrorScope().catch(() => {});
      this.destroy();
      throw error;
    }
  }

  async memory(): Promise<Uint8Array> {
    this.#current = await this.#free.shift()!;
    return new Uint8Array(this.#current.getMappedRange());
  }

  take(rowCount: number): void {
    const { device, memory, pipelines, dispatchRow } = this.#context;
    const { stage, ranges, layout, geometry, harmonics, rows, offsets, ...shared } = this.#held!;
    const staging = this.#current!;
    const first = this.#rowsTaken;
    const end = first + rowCount;
    this.#current = null;
    this.#rowsTaken = end;
    staging.unmap();
    const dispatches = new Dispatches(device, pipelines, memory, dispatchRow);
    for (const [page, range] of ranges.entries()) {
      const start = Math.max(first, range.start);
      const rowsOfPage = Math.min(end, range.end) - start;
      if (rowsOfPage <= 0) continue;
      const parameters = IngestParameters.pack({
        offsets,
        strideBytes: layout.strideBytes,
        isBigEndian: Number(layout.isBigEndian),
        firstRow: start - first,
        rowCount: rowsOfPage,
        pageSlot: start - range.start,
        maskRow: start,
        faintLogit: orderedBits(FAINT_LOGIT),
        dispatchRow,
      });
      const { dropMask, facts, logScaleRests } = shared;
      const bindings = {
        rows,
        dropMask,
        facts,
        geometry: geometry[page],
        harmonics: harmonics[page],
        ...(logScaleRests && { logScaleRests }),
      };
      dispatches.add(stage, parameters, bindings, Math.ceil(rowsOfPage / CHUNK_SPLATS));
    }
    const encoder = device.createCommandEncoder({ label: 'ingest rows' });
    encoder.copyBufferToBuffer(staging, 0, rows, 0, roundUp(rowCount * layout.strideBytes, 4));
    const parameters = dispatches.record(encoder, 'ingest rows');
    device.queue.submit([encoder.finish()]);
    memory.destroy(parameters);
    this.#free.push(mapped(staging));
  }

  /**
   * Puts the splats into storage order. The planes are the caller's then; all else is freed.
   *
   * @throws GpuLimitError; SplatFileError 'empty' if no row was kept; nothing is left allocated then.
   */
  async finish(): Promise<IngestedCloud> {
    const { device, pipelines } = this.#context;
    const { layout, facts } = this.#held!;
    for (const staging of this.#staging) this.#destroy(staging);
    this.#destroy(this.#held!.rows);
    const arranged: GPUBuffer[] = [];
    try {
      const found = readRowFacts(await readWords(device, facts), layout.count, layout.shDegree);
      if (found.count === 0) throw emptyError(this.#options.name, found.dropped);
      await pipelines.prepare(this.#lateStages());
      const cloud = await this.#arrange(found, arranged);
      return cloud;
    } catch (error) {
      for (const buffer of arranged) this.#context.memory.destroy(buffer);
      throw error;
    } finally {
      this.destroy();
    }
  }

  /** Frees everything. */
  destroy(): void {
    for (const buffer of [...this.#buffers]) this.#destroy(buffer);
    this.#held = null;
  }

  #memoryError(): GpuLimitError {
    const { name } = this.#options;
    const bytes = [...this.#buffers].reduce((sum, buffer) => sum + buffer.size, 0);
    const advice = 'Load fewer splats, or with a coarser accuracy.';
    return new GpuLimitError(
      'memory',
      bytes,
      0,
      `${name} needs ${bytes} bytes of the GPU's memory, which it lacks. ${advice}`,
    );
  }

  #destroy(buffer: GPUBuffer): void {
    if (this.#buffers.delete(buffer)) this.#context.memory.destroy(buffer);
  }

  /** Stages that run after the last row. Whether rows were dropped is not known before. */
  #lateStages(): StageDefinition[] {
    const { geometryPrecision } = this.#options;
    return [
      ingestSettle(geometryPrecision),
      ...arrangeStages({ geometryPrecision }, false),
      ...arrangeStages({ geometryPrecision }, true),
    ];
  }

  /** @param made lists the buffers that the cloud will hold, as soon as they exist. */
  async #arrange(found: RowFacts, made: GPUBuffer[]): Promise<IngestedCloud> {
    const { device } = this.#context;
    const { geometryPrecision, shPrecision, name } = this.#options;
    const held = this.#held!;
    const origin = chooseOrigin(found.min, found.max);
    const range = logScaleRange(...found.logScales);
    this.#settle(origin, range.step, found.logScales[0]);
    const about = (corner: readonly number[]) =>
      corner.map((value, axis) => Math.fround(value - origin[axis]));
    const { trueShDegree } = found.facts;
    const { ranges, geometry, harmonics, dropMask, layout } = held;
    const precision = { geometryPrecision, shPrecision };
    const planes = arrangePlanes(this.#context, {
      ...precision,
      name,
      ranges,
      geometry,
      harmonics,
      dropMask,
      shDegree: layout.shDegree,
      keptShDegree: trueShDegree,
      kept: found.count,
      frame: mortonFrame(about(found.min), about(found.max)),
      logScaleRange: range,
    });
    // The planes are in other hands now: those that were kept, and those that took the place of others.
    for (const buffer of [...geometry, ...harmonics]) this.#buffers.delete(buffer);
    made.push(...planes.geometry, ...planes.harmonics, ...planes.chunks);
    this.#buffers.add(planes.fileRows);
    const samples = await this.#samples(planes, found.count);
    const fileIndices = await readWords(device, planes.fileRows);
    const chunkWords = await Promise.all(planes.chunks.map((page) => readWords(device, page)));
    const chunks = await new Blob(chunkWords).arrayBuffer();
    return {
      contents: {
        count: found.count,
        origin,
        bounds: totalBounds(chunks, origin),
        robustBounds: robustBounds(samples, origin),
        dropped: found.dropped,
        fileIndices,
        facts: found.facts,
        chunks,
        logScaleRange: range,
        precision,
      },
      planes: { ...planes, ...precision, shDegree: trueShDegree },
    };
  }

  #settle(origin: readonly number[], logScaleStep: number, minLogScale: number): void {
    const { device, memory, pipelines, dispatchRow } = this.#context;
    const { geometryPrecision } = this.#options;
    const { ranges, geometry, logScaleRests } = this.#held!;
    const dispatches = new Dispatches(device, pipelines, memory, dispatchRow);
    for (const [page, { start, end }] of ranges.entries()) {
      const parameters = SettleParameters.pack({
        origin,
        logScaleStep,
        minLogScale: ingestLogScaleSteps(minLogScale),
        slotCount: end - start,
        firstSlot: start,
        dispatchRow,
      });
      const bindings = { geometry: geometry[page], ...(logScaleRests && { logScaleRests }) };
      const workgroups = Math.ceil((end - start) / CHUNK_SPLATS);
      dispatches.add(ingestSettle(geometryPrecision), parameters, bindings, workgroups);
    }
    const encoder = device.createCommandEncoder({ label: 'ingest settle' });
    const parameters = dispatches.record(encoder, 'ingest settle');
    device.queue.submit([encoder.finish()]);
    memory.destroy(parameters);
    if (logScaleRests) this.#destroy(logScaleRests);
  }

  /** Coordinates of the splats that robust bounds are taken from, by axis. */
  async #samples({ ranges, geometry }: ArrangedPlanes, count: number): Promise<Float32Array[]> {
    const { device, memory, pipelines, dispatchRow } = this.#context;
    const indices = boundsSamples(count);
    const list = memory.createFilledBuffer('ingest samples', indices);
    const axes: GPUBuffer[] = [];
    try {
      const dispatches = new Dispatches(device, pipelines, memory, dispatchRow);
      for (let word = 0; word < 3; word++) {
        const usage = GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_SRC;
        const words = memory.createBuffer('ingest sampled words', 4 * indices.length, usage);
        axes.push(words);
        for (const [page, { start, end }] of ranges.entries()) {
          const parameters = PermuteParameters.pack({
            word,
            wordsPerSplat: GEOMETRY_WORDS[this.#options.geometryPrecision],
            mask: 0xffffffff,
            pageStart: start,
            pageEnd: end,
            count: indices.length,
            dispatchRow,
          });
          const workgroups = Math.ceil(indices.length / CHUNK_SPLATS);
          dispatches.add(ingestGather, parameters, { plane: geometry[page], list, words }, workgroups);
        }
      }
      const encoder = device.createCommandEncoder({ label: 'ingest samples' });
      axes.push(dispatches.record(encoder, 'ingest samples'));
      device.queue.submit([encoder.finish()]);
      const words = await Promise.all(axes.slice(0, 3).map((axis) => readWords(device, axis)));
      return words.map(({ buffer }) => new Float32Array(buffer));
    } finally {
      for (const buffer of [list, ...axes]) memory.destroy(buffer);
    }
  }
}

function mapped(staging: GPUBuffer): Promise<GPUBuffer> {
  const done = staging.mapAsync(GPUMapMode.WRITE).then(() => staging);
  // Destroying the buffer rejects this, and by then nobody may wait for it.
  done.catch(() => {});
  return done;
}
