import { DestroyedError, GpuLimitError, SplatSourceError } from '../errors.ts';
import type { Counting } from '../gpu/engine-counters.ts';
import type { GpuMemory } from '../gpu/gpu-memory.ts';
import type { Pipelines, StageDefinition } from '../gpu/pipelines.ts';
import { loadSplats } from '../io/load-splats.ts';
import type { ReadOptions } from '../io/splat-source.ts';
import { CHUNK_SPLATS } from '../layout/constants.ts';
import { RepackParameters } from '../layout/packing-structs.ts';
import { Chunk } from '../layout/structs.ts';
import { GEOMETRY_WORDS } from '../packing/geometry.ts';
import { type Harmonics, shWordsPerSplat } from '../packing/harmonics.ts';
import { packSet } from '../packing/pack-set.ts';
import type { PackedCloud } from '../packing/packed-cloud.ts';
import type { CloudPrecision } from '../packing/precision.ts';
import type { SplatSet } from '../splats/splat-set.ts';
import { dispatchSize } from '../stages/dispatch.ts';
import { repackGeometry } from '../stages/repack-geometry.ts';
import { type RepackShVariant, repackSh } from '../stages/repack-sh.ts';
import type { MakeOptions } from './cloud-leases.ts';
import { isGeometryAsFine, isShAsFine, type Plane, uploadGeometry, uploadHarmonics } from './cloud-planes.ts';
import { createGeometry, createHarmonics } from './create-plane.ts';
import type { CloudSource, SplatCloud } from './splat-cloud.ts';

export interface PlaneMakerContext {
  readonly device: GPUDevice;
  readonly memory: GpuMemory;
  readonly pipelines: Pipelines;
  readonly counting: Pick<Counting, 'uploadedBytes'>;
  readonly dispatchRow: number;
  /** Reason why no planes can be made any more, or null. */
  readonly destroyedBecause: () => string | null;
  /** Compiles the pipelines that draw the cloud with this precision, in every view that shows it. */
  readonly compileFor: (cloud: SplatCloud, precision: CloudPrecision) => Promise<void>;
}

type RepackStage = StageDefinition<'parameters' | 'finer' | 'coarser'>;

/** Work that a request needs; null parts are not needed. */
interface Work {
  readonly freshGeometry: PackedCloud['geometry'] | null;
  readonly freshSh: PackedCloud['harmonics'] | null;
  readonly geometryStage: RepackStage | null;
  readonly shStage: RepackStage | null;
}

/** A plane that is not part of its cloud yet. */
interface MadePlane {
  readonly plane: Plane;
  readonly adopt: () => void;
}

/** Makes the planes that leases of clouds claim. */
export class PlaneMaker {
  readonly #context: PlaneMakerContext;
  /** Per cloud: settled when no request reads its sources any more. */
  readonly #readings = new WeakMap<SplatCloud, Promise<unknown>>();

  constructor(context: PlaneMakerContext) {
    this.#context = context;
  }

  /**
   * Adds the planes of `wanted` to those that `cloud` holds, all at once. Rejects with the errors that `SplatCloud.hold`
   * lists; nothing changes then.
   */
  async make(cloud: SplatCloud, wanted: CloudPrecision, options: MakeOptions): Promise<void> {
    if (await this.#makeFrom(null, cloud, wanted, options)) return;
    // Requests read sources in turn, because the second request for a precision finds the planes that the first has made.
    // Requests that need no reading do not wait.
    const earlier = this.#readings.get(cloud);
    const reading = this.#readAndMake(earlier, cloud, wanted, options);
    this.#readings.set(cloud, Promise.allSettled([earlier, reading]));
    await reading;
  }

  async #readAndMake(
    earlier: Promise<unknown> | undefined,
    cloud: SplatCloud,
    wanted: CloudPrecision,
    options: MakeOptions,
  ): Promise<void> {
    const { signal } = options;
    signal.throwIfAborted();
    await Promise.race([earlier, whenAborted(signal)]);
    signal.throwIfAborted();
    let fresh: PackedCloud | null = null;
    while (!(await this.#makeFrom(fresh, cloud, wanted, options))) {
      fresh = await readAgain(cloud, missingOf(cloud, wanted), options);
    }
  }

  /** @returns false, without making anything, if both the cloud's planes and `fresh` are too coarse. */
  async #makeFrom(
    fresh: PackedCloud | null,
    cloud: SplatCloud,
    wanted: CloudPrecision,
    { signal }: MakeOptions,
  ): Promise<boolean> {
    const { held } = cloud.planes;
    const work = workFor(cloud, wanted, fresh);
    if (!work) return false;
    this.#checkUsable(signal);
    const { geometryStage, shStage } = work;
    await this.#context.pipelines.prepare([geometryStage, shStage].filter((stage) => stage !== null));
    // Before the planes change: the old pipelines cannot draw the new planes.
    await this.#context.compileFor(cloud, wanted);
    this.#checkUsable(signal);
    // Another claim may have been met or released while shaders compiled.
    if (cloud.planes.held !== held) return this.#makeFrom(fresh, cloud, wanted, { signal });
    const made: MadePlane[] = [];
    try {
      await this.#withMemoryFor(cloud, wanted, bytesOf(cloud, wanted, work), () =>
        this.#make(cloud, wanted, work, made),
      );
      this.#checkUsable(signal);
    } catch (error) {
      for (const { plane } of made) cloud.planes.free(plane);
      throw error;
    }
    // Synchronous from here on: the next request relies on the planes that it finds.
    for (const { adopt } of made) adopt();
    return true;
  }

  /** Uploads and repacks. Lists each plane in `made` as soon as it exists, so that the caller can free it. */
  #make(cloud: SplatCloud, wanted: CloudPrecision, work: Work, made: MadePlane[]): void {
    const { planes } = cloud;
    const { freshGeometry, freshSh, geometryStage, shStage } = work;
    const keepGeometry = (precision: CloudPrecision['geometryPrecision'], plane: Plane) => {
      made.push({ plane, adopt: () => planes.adoptGeometry(precision, plane) });
      return plane;
    };
    const keepSh = (precision: CloudPrecision['shPrecision'], plane: Plane) => {
      made.push({ plane, adopt: () => planes.adoptSh(precision, plane) });
      return plane;
    };
    let geometry = planes.geometryPlane(planes.held.geometry[0])!;
    let sh = planes.shPlane(planes.held.sh[0])!;
    if (freshGeometry) {
      geometry = keepGeometry(freshGeometry.precision, uploadGeometry(planes.place, freshGeometry));
    }
    if (freshSh) {
      sh = keepSh(freshSh.precision, uploadHarmonics(planes.place, freshSh));
    }
    if (geometryStage) {
      const coarser = keepGeometry(
        wanted.geometryPrecision,
        createGeometry(planes.place, wanted.geometryPrecision),
      );
      this.#repack(cloud, geometryStage, geometry, coarser);
    }
    if (shStage) {
      const coarser = keepSh(
        wanted.shPrecision,
        createHarmonics(planes.place, planes.shDegree, wanted.shPrecision),
      );
      this.#repack(cloud, shStage, sh, coarser);
    }
    this.#context.counting.uploadedBytes += uploadedBytes(work);
  }

  #repack({ planes, logScaleRange }: SplatCloud, stage: RepackStage, finer: Plane, coarser: Plane): void {
    const { device, memory, pipelines, dispatchRow } = this.#context;
    const made: GPUBuffer[] = [];
    try {
      const encoder = device.createCommandEncoder({ label: stage.stage });
      const pass = encoder.beginComputePass({ label: stage.stage });
      pass.setPipeline(pipelines.compute(stage)!);
      for (const [page, { start, end }] of planes.ranges.entries()) {
        const splatCount = end - start;
        const logScales = [logScaleRange.min, logScaleRange.step];
        const contents = RepackParameters.pack({ logScales, splatCount, dispatchRow });
        const usage = GPUBufferUsage.UNIFORM | GPUBufferUsage.COPY_DST;
        const parameters = memory.createBuffer('repack parameters', RepackParameters.bytes, usage);
        made.push(parameters);
        device.queue.writeBuffer(parameters, 0, contents);
        const bindings = { parameters, finer: finer[page], coarser: coarser[page] };
        pass.setBindGroup(0, pipelines.bindGroup(stage, bindings));
        const workgroups = Math.ceil(splatCount / CHUNK_SPLATS);
        pass.dispatchWorkgroups(...dispatchSize(workgroups, dispatchRow));
      }
      pass.end();
      device.queue.submit([encoder.finish()]);
    } finally {
      for (const buffer of made) memory.destroy(buffer);
    }
  }

  /** Calls `make`. @throws GpuLimitError if its buffers do not fit into the GPU's memory. */
  async #withMemoryFor(
    { name }: SplatCloud,
    wanted: CloudPrecision,
    neededBytes: number,
    make: () => void,
  ): Promise<void> {
    const { device } = this.#context;
    device.pushErrorScope('out-of-memory');
    let thrown: unknown = null;
    try {
      make();
    } catch (error) {
      thrown = error;
    }
    const lacking = await device.popErrorScope().catch((cause: Error) => {
      throw new DestroyedError('This request', cause.message);
    });
    // If a buffer cannot be mapped for its contents, creating it throws a RangeError instead.
    if (lacking || thrown instanceof RangeError) {
      const message = `${name} does not fit into the GPU's memory with ${describe(wanted)} (${neededBytes} bytes more); it is unchanged. Request a coarser precision.`;
      throw new GpuLimitError('memory', neededBytes, 0, message);
    }
    if (thrown) throw thrown;
  }

  #checkUsable(signal: AbortSignal): void {
    signal.throwIfAborted();
    const reason = this.#context.destroyedBecause();
    if (reason !== null) throw new DestroyedError('This request', reason);
  }
}

/** Returns the precision to read, so that `wanted` can be made from it and from the planes that `cloud` holds. */
function missingOf(
  { planes }: SplatCloud,
  { geometryPrecision, shPrecision }: CloudPrecision,
): CloudPrecision {
  const { geometry, sh } = planes.held;
  // Read whatever is not missing as coarsely as possible: at degree 3, the finest harmonics take four times the memory.
  return {
    geometryPrecision: isGeometryAsFine(geometry[0], geometryPrecision) ? 'packed' : geometryPrecision,
    shPrecision: isShAsFine(sh[0], shPrecision) ? 'u8' : shPrecision,
  };
}

/** Returns the work until `cloud` holds `wanted`; null if both its planes and `fresh` are too coarse. */
function workFor(
  { planes, shDegree }: SplatCloud,
  { geometryPrecision, shPrecision }: CloudPrecision,
  fresh: PackedCloud | null,
): Work | null {
  const [finestGeometry] = planes.held.geometry;
  const [finestSh] = planes.held.sh;
  const freshGeometry = fresh && !isGeometryAsFine(finestGeometry, geometryPrecision) ? fresh.geometry : null;
  const freshSh = fresh && !isShAsFine(finestSh, shPrecision) ? fresh.harmonics : null;
  const isFineEnough =
    isGeometryAsFine(freshGeometry?.precision ?? finestGeometry, geometryPrecision) &&
    isShAsFine(freshSh?.precision ?? finestSh, shPrecision);
  if (!isFineEnough) return null;
  const hasGeometry =
    planes.geometryPlane(geometryPrecision) || freshGeometry?.precision === geometryPrecision;
  const hasSh = planes.shPlane(shPrecision) || freshSh?.precision === shPrecision;
  // From the finest available, so that nothing is rounded twice needlessly.
  const from = (freshSh?.precision ?? finestSh) as RepackShVariant['from'];
  return {
    freshGeometry,
    freshSh,
    geometryStage: hasGeometry ? null : repackGeometry,
    shStage: hasSh ? null : repackSh({ degree: shDegree, from, to: shPrecision as RepackShVariant['to'] }),
  };
}

function uploadedBytes({ freshGeometry, freshSh }: Work): number {
  return (freshGeometry?.words.byteLength ?? 0) + (freshSh?.words.byteLength ?? 0);
}

/** Bytes that `work` allocates. */
function bytesOf({ count, shDegree }: SplatCloud, wanted: CloudPrecision, work: Work): number {
  const geometryWords = work.geometryStage ? GEOMETRY_WORDS[wanted.geometryPrecision] : 0;
  const shWords = work.shStage ? shWordsPerSplat(shDegree, wanted.shPrecision) : 0;
  return uploadedBytes(work) + 4 * count * (geometryWords + shWords);
}

/**
 * Reads the splats of `cloud` at least as finely as `wanted` from the first source that has them, and verifies that they are
 * the same splats.
 */
async function readAgain(
  cloud: SplatCloud,
  wanted: CloudPrecision,
  options: MakeOptions,
): Promise<PackedCloud> {
  const { sources, name } = cloud;
  const gone = `a finer precision (${describe(wanted)}) must be read again, and the source is gone; load it from a URL, a File or a Blob, or pass its source when adding it.`;
  let problem: unknown = new SplatSourceError(name, gone);
  for (const source of sources) {
    try {
      return await readFrom(source, cloud, wanted, options);
    } catch (error) {
      options.signal.throwIfAborted();
      problem = error;
    }
  }
  throw problem;
}

async function readFrom(
  source: CloudSource,
  cloud: SplatCloud,
  wanted: CloudPrecision,
  options: MakeOptions,
): Promise<PackedCloud> {
  const { name, shDegree } = cloud;
  const fresh = await packedFrom(source, wanted, { name, ...options });
  const { geometry, harmonics } = fresh;
  const isFine =
    isGeometryAsFine(geometry.precision, wanted.geometryPrecision) &&
    (shDegree === 0 || isShAsFine(harmonics.precision, wanted.shPrecision));
  if (!isFine) {
    const has = describe({ geometryPrecision: geometry.precision, shPrecision: harmonics.precision });
    throw new SplatSourceError(
      name,
      `its source has only ${has}, not ${describe(wanted)}; load it with that, or from a URL, a File or a Blob.`,
    );
  }
  if (!isSameSplats(cloud, fresh)) {
    const message = `its source has other splats than when it was loaded (${fresh.count}, then ${cloud.count}); it is unchanged. Load it again to see them.`;
    throw new SplatSourceError(name, message);
  }
  return fresh;
}

function describe({ geometryPrecision, shPrecision }: CloudPrecision): string {
  return `${geometryPrecision} geometry, ${shPrecision} harmonics`;
}

async function packedFrom(
  source: CloudSource,
  wanted: CloudPrecision,
  options: ReadOptions,
): Promise<PackedCloud> {
  if (isPackedCloud(source)) return source;
  if (isSplatSet(source)) return packSet(source, wanted);
  return loadSplats(source, { ...options, ...wanted });
}

function isPackedCloud(source: CloudSource): source is PackedCloud {
  return typeof source === 'object' && 'geometry' in source;
}

function isSplatSet(source: CloudSource): source is SplatSet<Harmonics> {
  return typeof source === 'object' && 'logScales' in source;
}

/**
 * Compares the rows kept, their order, and each chunk's bounds (positions and sizes). Does not compare colours: the held ones
 * are too coarse.
 */
function isSameSplats(cloud: SplatCloud, fresh: PackedCloud): boolean {
  return (
    cloud.count === fresh.count &&
    cloud.shDegree === fresh.harmonics.degree &&
    cloud.origin.every((value, axis) => value === fresh.origin[axis]) &&
    cloud.logScaleRange.min === fresh.geometry.logScaleRange.min &&
    cloud.logScaleRange.step === fresh.geometry.logScaleRange.step &&
    isSameWords(cloud.fileIndices, fresh.fileIndices) &&
    isSameChunks(new Float32Array(cloud.chunks), new Float32Array(fresh.chunks))
  );
}

/** Scales may differ by what they are rounded by where the GPU takes them from packed splats. */
function isSameChunks(a: Float32Array, b: Float32Array): boolean {
  const scaleAt = Chunk.offsets.maxScale / 4;
  const isSameAt = (i: number) =>
    i % (Chunk.bytes / 4) === scaleAt ? Math.abs(a[i] - b[i]) <= 1e-3 * b[i] : a[i] === b[i];
  return a.length === b.length && a.every((_, i) => isSameAt(i));
}

function isSameWords(a: Uint32Array, b: Uint32Array): boolean {
  if (a.length !== b.length) return false;
  for (let i = 0; i < a.length; i++) if (a[i] !== b[i]) return false;
  return true;
}

function whenAborted(signal: AbortSignal): Promise<void> {
  return new Promise((resolve) => signal.addEventListener('abort', () => resolve(), { once: true }));
}
