import {
  CloudPlanes,
  type PageRange,
  type Plane,
  planeOf,
  splatsPerPage,
} from '../../clouds/cloud-planes.ts';
import { createGeometry } from '../../clouds/create-plane.ts';
import type { DispatchContext } from '../../clouds/ingest/dispatches.ts';
import { readChunks } from '../../clouds/ingest/read-chunks.ts';
import { SplatCloud, type SplatCloudOptions } from '../../clouds/splat-cloud.ts';
import { DestroyedError, GpuLimitError, InvalidArgumentError } from '../../data/errors.ts';
import { given, type Members, wrongArgument } from '../../data/given.ts';
import { CHUNK_WORDS } from '../../data/layout/chunk-words.ts';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { BufferParameters } from '../../data/layout/packing-structs.ts';
import { Chunk } from '../../data/layout/structs.ts';
import { isFiniteF32 } from '../../data/math/float-step.ts';
import { chunkCountOf, setLogScales } from '../../data/packing/chunks.ts';
import { LOG_SCALE_LIMIT } from '../../data/packing/log-scale.ts';
import { type Bounds, totalBounds } from '../../data/packing/packed-cloud.ts';
import type { CloudPrecision, GeometryPrecision } from '../../data/packing/precision.ts';
import { GPU_FAULTS } from '../../data/splats/splat-set.ts';
import type { GpuMemory } from '../../gpu/gpu-memory.ts';
import { type Dispatch, dispatchOf, recordDispatches } from '../../gpu/passes.ts';
import type { StageDefinition } from '../../gpu/pipelines.ts';
import { readWords } from '../../gpu/read-buffer.ts';
import { dispatchSize } from '../../stages/dispatch.ts';
import { packBuffers } from './pack-buffers.stages.ts';

/** Float32 values of splats in a buffer of the engine's device. */
export interface SplatBuffer {
  /** Has the usage STORAGE, and lives at least as long as the splats. */
  readonly buffer: GPUBuffer;
  /** Offset of the first splat's first value, in bytes, a multiple of 4. Default: 0. */
  readonly offsetBytes?: number;
  /**
   * Distance of successive splats, in bytes, a multiple of 4; 16 for an `array<vec3f>` of WGSL.
   * Default: the values follow each other.
   */
  readonly strideBytes?: number;
}

/**
 * Splats in GPU buffers. Row i is the i-th splat of each. Several may be in one buffer, with offsets
 * and a stride. Conventions are those of `SplatArrays`.
 */
export interface GpuSplatsOptions {
  /** For messages and labels. Default: `splats`. */
  readonly name?: string;
  /** Number of splats, 1 or more. Splats with an opacity of 0 are not drawn. */
  readonly count: number;
  /** 3 values per splat: centre x, y, z. */
  readonly positions: SplatBuffer;
  /** 3 values per splat: standard deviations along the local axes, in units of `positions`. */
  readonly scales: SplatBuffer;
  /** 3 values per splat: r, g, b, sRGB-encoded, where 0 is black and 1 is white. */
  readonly colors: SplatBuffer;
  /** 4 values per splat: a quaternion x, y, z, w of any length above 0. Default: no turn. */
  readonly rotations?: SplatBuffer;
  /** 1 value per splat: opacity at its centre, clamped to 0…1. Default: 1. */
  readonly opacities?: SplatBuffer;
  /**
   * Box that holds the centres; splats outside are not drawn. Depths are sorted in fewer passes, and
   * hosts know where the cloud is. Default: everywhere.
   */
  readonly bounds?: Bounds;
}

/** Numbers of splats that are not drawn, by their first fault; faults that no splat has are absent. */
export type GpuSplatFaults = Readonly<Partial<Record<(typeof GPU_FAULTS)[number], number>>>;

/** Values per splat of the columns, in the order of `BufferParameters.columns`. */
const WIDTHS = { positions: 3, scales: 3, rotations: 4, opacities: 1, colors: 3 } as const;

type ColumnName = keyof typeof WIDTHS;

/** Where a column is, in bytes. */
interface Column {
  readonly name: ColumnName;
  readonly buffer: GPUBuffer;
  readonly offset: number;
  readonly stride: number;
  /** Of one splat. */
  readonly bytes: number;
}

/** What splats are packed from and into. */
interface Parts {
  /** By precision; the objects keep their pipelines. */
  readonly stages: Readonly<Record<GeometryPrecision, StageDefinition>>;
  readonly columns: readonly Column[];
  /** A buffer per page. */
  readonly parameters: Plane;
  readonly planes: CloudPlanes;
}

/** Far beyond any scene, and small enough that float32 has the squares. */
const EVERYWHERE: Bounds = { min: [-1e18, -1e18, -1e18], max: [1e18, 1e18, 1e18] };
const ADVICE = 'Make fewer splats, or pack them with a coarser accuracy.';

/** The services of an engine that splats in buffers need. */
export interface GpuSplatsContext extends DispatchContext {
  /** Precision of the first planes. */
  readonly precision: CloudPrecision;
  /** Options of the cloud. */
  readonly made: SplatCloudOptions;
}

/**
 * Splats that GPU work of the application writes into buffers, and a cloud that draws them. Made by
 * `engine.addGpuSplats`. Nothing passes through the CPU: a compute pass packs the buffers into the
 * cloud's planes, and gives the bounds by which splats are culled.
 *
 * The cloud is drawn in full detail, and has no edits, rays or colliders. Its row i is splat i of the
 * buffers. `cloud.destroy()` frees its memory, and leaves the buffers to the application.
 *
 * A splat with NaN or infinity, outside of the bounds or of no opacity is not drawn, and changes
 * nothing else. Negative scales count as positive ones.
 */
export class GpuSplats {
  /** The cloud to draw. */
  readonly cloud: SplatCloud;
  /** Its memory is the splats' own. */
  readonly #context: GpuSplatsContext;
  readonly #parts: Parts;
  /** By the first buffer of the geometry that they write. */
  readonly #dispatches = new WeakMap<GPUBuffer, readonly Dispatch[]>();
  #isChanged = true;
  #failure: Error | null = null;

  /**
   * @internal Use `engine.addGpuSplats`.
   *
   * @throws the errors that it lists.
   */
  static async make(context: GpuSplatsContext, options: GpuSplatsOptions): Promise<GpuSplats> {
    const { device, pipelines, precision, made } = context;
    const { count, bounds = EVERYWHERE } = checkOptions(options);
    const columns = columnsOf(options);
    const stages = stagesOf(columns);
    const ranges = pagesOf(device.limits, count, columns, made.name);
    await pipelines.prepare([stages[precision.geometryPrecision]]);
    const memory = context.memory.part();
    const allocate = () => {
      const place = { memory, name: made.name, ranges };
      const parameters = planeOf(place, ({ start, end }, page) =>
        uniformBuffer(memory, `${made.name} parameters ${page}`, {
          boundsMin: bounds.min,
          boundsMax: bounds.max,
          splatCount: end - start,
          dispatchRow: context.dispatchRow,
          columns: columnWords(device.limits, columns, start),
        }),
      );
      const usage = GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_SRC;
      const chunks = planeOf(place, ({ start, end }, page) =>
        memory.createBuffer(`${made.name} chunks ${page}`, Chunk.bytes * chunkCountOf(end - start), usage),
      );
      const geometry = createGeometry(place, precision.geometryPrecision);
      const planes = new CloudPlanes(memory, made.name, {
        ...precision,
        shDegree: 0,
        ranges,
        chunks,
        geometry,
        harmonics: [],
      });
      return { stages, columns, parameters, planes };
    };
    try {
      const { result, checked } = memory.guard(made.name, ADVICE, allocate);
      await Promise.all([checked, ...columns.map((column) => checkColumn(device, column))]);
      const splats = new GpuSplats({ ...context, memory }, result, { count, bounds });
      await splats.#pack();
      splats.#checkUsable();
      return splats;
    } catch (error) {
      memory.destroyAll();
      throw error;
    }
  }

  private constructor(
    context: GpuSplatsContext,
    parts: Parts,
    { count, bounds }: { readonly count: number; readonly bounds: Bounds },
  ) {
    this.#context = context;
    this.#parts = parts;
    const chunks = chunksEverywhere(count, bounds);
    const contents = {
      count,
      origin: [0, 0, 0],
      bounds,
      robustBounds: bounds,
      dropped: {},
      fileIndices: Uint32Array.from({ length: count }, (_, row) => row),
      facts: {
        declaredShDegree: 0,
        trueShDegree: 0,
        shBandReach: [],
        paletteEntries: null,
        isIsotropic: false,
        isAntialiased: null,
        fileFacts: null,
      },
      chunks,
      precision: context.precision,
    } as const;
    this.cloud = new SplatCloud(context.device, parts.planes, contents, {
      ...context.made,
      makePlanes: (_, precision, { signal }) => this.#makePlanes(precision, signal),
    });
    this.cloud.addFeature({
      name: 'buffers of the GPU',
      lacksLevels:
        'the GPU makes its splats anew, and levels of detail are made of splats that last: draw it in full detail.',
      flush: () => this.#flush(),
      // Planes made later are packed from the buffers, like all others.
      rebase: async () => () => {},
      readChunks: () => this.#readChunks(),
      end: () => parts.planes.free(parts.parameters),
    });
  }

  /**
   * Packs the buffers again before the next frame: call it after the submission that changes them.
   * Frames without a call before them draw what was packed last, and cost no more than frames of any
   * other cloud.
   *
   * @throws DestroyedError if the cloud, its engine or a buffer was destroyed.
   * @example
   * device.queue.submit([encoder.finish()]); // writes the buffers
   * splats.changed();
   * view.render({ camera, clouds: [{ cloud: splats.cloud }], widthPx, heightPx });
   */
  changed(): void {
    this.#checkUsable();
    this.#isChanged = true;
  }

  /**
   * Packs the buffers and counts the splats with faults. Waits for the GPU: call it while you look for
   * a mistake, not in each frame.
   *
   * @throws DestroyedError as `changed` does; GpuLimitError if memory is lacking.
   * @example
   * const faults = await splats.countFaults(); // { 'non-finite-position': 3 }
   */
  async countFaults(): Promise<GpuSplatFaults> {
    this.#checkUsable();
    const { device, memory, pipelines } = this.#context;
    const { name, planes } = this.cloud;
    const [geometryPrecision] = planes.held.geometry;
    const stage = stagesOf(this.#parts.columns, true)[geometryPrecision];
    await pipelines.prepare([stage]);
    this.#checkUsable();
    const usage = GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_SRC;
    const { result: faults, checked } = memory.guard(name, ADVICE, () =>
      memory.createBuffer(`${name} faults`, 4 * GPU_FAULTS.length, usage),
    );
    try {
      await checked;
      this.changed();
      this.#flush();
      const plane = planes.geometryPlane(planes.held.geometry[0])!;
      await this.#submit(this.#dispatchesOf(stage, plane, faults));
      const counts = await readWords(device, faults);
      this.#checkUsable();
      return Object.fromEntries(
        GPU_FAULTS.map((fault, i) => [fault, counts[i]] as const).filter(([, count]) => count > 0),
      );
    } finally {
      memory.destroy(faults);
    }
  }

  /**
   * Reads the bounds of the drawn splats' centres back, for a first camera or for `bounds`. Waits for
   * the GPU: do not call it in each frame.
   *
   * @returns null if no splat is drawn.
   * @throws DestroyedError as `changed` does; GpuLimitError if memory is lacking.
   */
  async readBounds(): Promise<Bounds | null> {
    this.#checkUsable();
    this.#flush();
    const chunks = await this.#readChunks();
    this.#checkUsable();
    const words = CHUNK_WORDS.count;
    const drawn = Array.from({ length: chunks.length / words }, (_, chunk) =>
      chunks.subarray(words * chunk, words * (chunk + 1)),
    ).filter((chunk) => chunk[CHUNK_WORDS.minLogScale] >= -LOG_SCALE_LIMIT);
    if (drawn.length === 0) return null;
    const kept = new Float32Array(words * drawn.length);
    for (const [i, chunk] of drawn.entries()) kept.set(chunk, words * i);
    return totalBounds(kept.buffer, this.cloud.origin);
  }

  async #readChunks(): Promise<Float32Array> {
    const { planes, device } = this.cloud;
    return new Float32Array(await readChunks(device, { chunks: planes.chunksPlane, ranges: planes.ranges }));
  }

  #flush(): void {
    if (this.#isChanged && !this.cloud.isDestroyed && !this.#failure) void this.#pack();
  }

  /** Packs all planes that the cloud holds. Resolves when the device has accepted the commands. */
  #pack(): Promise<void> {
    this.#isChanged = false;
    const { planes } = this.cloud;
    const accepted = this.#submit(
      planes.held.geometry.flatMap((precision) => {
        const plane = planes.geometryPlane(precision)!;
        const known = this.#dispatches.get(plane[0]);
        const made = known ?? this.#dispatchesOf(this.#parts.stages[precision], plane);
        this.#dispatches.set(plane[0], made);
        return made;
      }),
    );
    this.cloud.markChanged();
    return accepted;
  }

  async #submit(dispatches: readonly Dispatch[]): Promise<void> {
    const { device } = this.#context;
    // Nothing else tells that the application has destroyed a buffer.
    device.pushErrorScope('validation');
    const encoder = device.createCommandEncoder({ label: 'pack buffers' });
    const pass = encoder.beginComputePass({ label: 'pack buffers' });
    recordDispatches(pass, dispatches);
    pass.end();
    device.queue.submit([encoder.finish()]);
    // A lost device does not answer; views report its loss.
    const error = await device.popErrorScope().catch(() => null);
    if (error) this.#failure = new DestroyedError(`A buffer of ${this.cloud.name}`, reasonOf(error));
  }

  #dispatchesOf(stage: StageDefinition, geometry: Plane, faults?: GPUBuffer): readonly Dispatch[] {
    const { pipelines, dispatchRow, device } = this.#context;
    const { columns, parameters, planes } = this.#parts;
    return planes.ranges.map(({ start, end }, page) => {
      const slices = columns.map((column) => [column.name, sliceOf(device.limits, column, start, end)]);
      const bindings = {
        ...Object.fromEntries(slices),
        parameters: parameters[page],
        geometry: geometry[page],
        chunks: planes.chunksPlane[page],
        ...(faults && { faults }),
      };
      return dispatchOf(pipelines, stage, bindings, dispatchSize(chunkCountOf(end - start), dispatchRow));
    });
  }

  /** Any precision can be made, since the buffers hold float32. */
  async #makePlanes({ geometryPrecision }: CloudPrecision, signal: AbortSignal): Promise<void> {
    const { planes, name } = this.cloud;
    const { pipelines, memory } = this.#context;
    await pipelines.prepare([this.#parts.stages[geometryPrecision]]);
    signal.throwIfAborted();
    if (planes.geometryPlane(geometryPrecision)) return;
    const { result: plane, checked } = memory.guard(name, ADVICE, () =>
      createGeometry(planes.place, geometryPrecision),
    );
    try {
      await checked;
      signal.throwIfAborted();
    } catch (error) {
      planes.free(plane);
      throw error;
    }
    planes.adoptGeometry(geometryPrecision, plane);
    this.#isChanged = true;
    this.cloud.markChanged();
  }

  #checkUsable(): void {
    this.cloud.checkUsable();
    if (this.#failure) throw this.#failure;
  }
}

const OPTIONS: Members = {
  name: 'a string?',
  count: 'a whole number',
  positions: 'an object',
  scales: 'an object',
  colors: 'an object',
  rotations: 'an object?',
  opacities: 'an object?',
  bounds: 'an object?',
};

/** @throws InvalidArgumentError naming the option. */
function checkOptions(options: GpuSplatsOptions): GpuSplatsOptions {
  const { count, bounds } = given(options, OPTIONS);
  if (count === 0) throw wrongArgument('count', count, '1 or more');
  if (!bounds) return options;
  for (const corner of ['min', 'max'] as const) {
    const values = given(bounds, { min: 'a list', max: 'a list' }, 'bounds')[corner];
    if (values.length !== 3 || !values.every(isFiniteF32))
      throw wrongArgument(`bounds.${corner}`, values, 'three finite numbers');
  }
  for (const axis of [0, 1, 2])
    if (bounds.min[axis] > bounds.max[axis])
      throw wrongArgument(`bounds.min[${axis}]`, bounds.min[axis], `at most bounds.max[${axis}]`);
  return options;
}

/** @throws InvalidArgumentError naming the option. */
function columnsOf(options: GpuSplatsOptions): Column[] {
  const { count } = options;
  return (Object.keys(WIDTHS) as ColumnName[]).flatMap((name) => {
    const column = options[name];
    if (!column) return [];
    const width = WIDTHS[name];
    const bytes = 4 * width;
    const members = {
      buffer: 'an object',
      offsetBytes: 'a whole number?',
      strideBytes: 'a whole number?',
    } as const;
    const { buffer, offsetBytes: offset = 0, strideBytes: stride = bytes } = given(column, members, name);
    given(buffer, { size: 'a number', usage: 'a number', destroy: 'a function' }, `${name}.buffer`);
    if (offset % 4 > 0) throw wrongArgument(`${name}.offsetBytes`, offset, 'a multiple of 4');
    if (stride % 4 > 0) throw wrongArgument(`${name}.strideBytes`, stride, 'a multiple of 4');
    if (stride < bytes)
      throw wrongArgument(`${name}.strideBytes`, stride, `at least ${bytes}, or splats would overlap`);
    if (!(buffer.usage & GPUBufferUsage.STORAGE))
      throw new InvalidArgumentError(
        `${name}.buffer`,
        `${name}.buffer lacks the usage STORAGE; create it with GPUBufferUsage.STORAGE.`,
      );
    // Only a buffer that was mapped at its creation can be: STORAGE excludes mapping later.
    if (buffer.mapState === 'mapped')
      throw new InvalidArgumentError(
        `${name}.buffer`,
        `${name}.buffer is mapped, so that the GPU may not read it; call its unmap() first.`,
      );
    const needed = offset + stride * (count - 1) + bytes;
    if (buffer.size < needed)
      throw new InvalidArgumentError(
        `${name}.buffer`,
        `${name}.buffer has ${buffer.size} bytes; ${count} splats every ${stride} bytes from byte ${offset} on need ${needed}.`,
      );
    return { name, buffer, offset, stride, bytes };
  });
}

/** @throws InvalidArgumentError if the engine's device cannot bind the buffer. */
async function checkColumn(device: GPUDevice, { name, buffer }: Column): Promise<void> {
  device.pushErrorScope('validation');
  const layout = device.createBindGroupLayout({
    entries: [{ binding: 0, visibility: GPUShaderStage.COMPUTE, buffer: { type: 'read-only-storage' } }],
  });
  device.createBindGroup({ layout, entries: [{ binding: 0, resource: { buffer, size: 4 } }] });
  // A lost device does not answer; `engine.lost` reports its loss.
  const error = await device.popErrorScope().catch(() => null);
  if (!error) return;
  const message = `${name}.buffer cannot be read on the engine's device; create it on engine.device. The GPU says: ${reasonOf(error)}`;
  throw new InvalidArgumentError(`${name}.buffer`, message);
}

/** The first line: the rest names calls of the engine. */
function reasonOf({ message }: GPUError): string {
  return message.split('\n')[0];
}

function stagesOf(columns: readonly Column[], countsFaults = false): Parts['stages'] {
  const has = (name: ColumnName) => columns.some((column) => column.name === name);
  const variant = { hasRotations: has('rotations'), hasOpacities: has('opacities'), countsFaults };
  return {
    f32: packBuffers({ ...variant, geometryPrecision: 'f32' }),
    packed: packBuffers({ ...variant, geometryPrecision: 'packed' }),
  };
}

type Limits = Pick<
  GPUSupportedLimits,
  'maxBufferSize' | 'maxStorageBufferBindingSize' | 'minStorageBufferOffsetAlignment'
>;

/** Pages whose planes and slices of the columns can be bound. @throws GpuLimitError if none can. */
function pagesOf(limits: Limits, count: number, columns: readonly Column[], name: string): PageRange[] {
  const bytes = Math.max(64, ...columns.map(({ stride }) => stride));
  const available = limits.maxStorageBufferBindingSize - limits.minStorageBufferOffsetAlignment;
  const { maxBufferSize } = limits;
  const splats = splatsPerPage({ maxBufferSize, maxStorageBufferBindingSize: available }, bytes);
  if (splats === 0) {
    const needed = CHUNK_SPLATS * bytes;
    const message = `${name} needs bindings of at least ${needed} bytes and this device allows ${available}. Use smaller strides.`;
    throw new GpuLimitError('maxStorageBufferBindingSize', needed, available, message);
  }
  return Array.from({ length: Math.ceil(count / splats) }, (_, page) => ({
    start: page * splats,
    end: Math.min(count, (page + 1) * splats),
  }));
}

/** The part of a column's buffer that splats `start` to `end` lie in. */
function sliceOf(limits: Limits, column: Column, start: number, end: number): GPUBufferBinding {
  const offset = alignedOffset(limits, column, start);
  const { buffer } = column;
  return { buffer, offset, size: column.offset + column.stride * (end - 1) + column.bytes - offset };
}

function alignedOffset(
  { minStorageBufferOffsetAlignment: alignment }: Limits,
  column: Column,
  start: number,
): number {
  return Math.floor((column.offset + column.stride * start) / alignment) * alignment;
}

/** First words in their slices, and strides in words, as `BufferParameters.columns` has them. */
function columnWords(limits: Limits, columns: readonly Column[], start: number): Uint32Array {
  const words = new Uint32Array(4 * Object.keys(WIDTHS).length);
  for (const [i, name] of Object.keys(WIDTHS).entries()) {
    const column = columns.find((each) => each.name === name);
    if (!column) continue;
    const first = column.offset + column.stride * start - alignedOffset(limits, column, start);
    words.set([first / 4, column.stride / 4], 4 * i);
  }
  return words;
}

function uniformBuffer(
  memory: GpuMemory,
  label: string,
  values: Parameters<typeof BufferParameters.pack>[0],
): GPUBuffer {
  const usage = GPUBufferUsage.UNIFORM | GPUBufferUsage.COPY_DST;
  const buffer = memory.createBuffer(label, BufferParameters.bytes, usage);
  memory.device.queue.writeBuffer(buffer, 0, BufferParameters.pack(values));
  return buffer;
}

/** Chunks for the CPU, which does not know where splats are: any frame may show each of them. */
function chunksEverywhere(count: number, { min, max }: Bounds): ArrayBuffer {
  const chunks = new Float32Array(CHUNK_WORDS.count * chunkCountOf(count));
  for (let chunk = 0; chunk < chunkCountOf(count); chunk++) {
    chunks.set(min, CHUNK_WORDS.count * chunk + CHUNK_WORDS.minPosition);
    chunks.set(max, CHUNK_WORDS.count * chunk + CHUNK_WORDS.maxPosition);
    setLogScales(chunks, chunk, { min: LOG_SCALE_LIMIT, step: 0 });
  }
  return chunks.buffer;
}
