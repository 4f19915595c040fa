import { DestroyedError, GpuLimitError, SplatSourceError } from '../errors.ts';
import type { Counting } from '../gpu/engine-counters.ts';
import type { GpuMemory } from '../gpu/gpu-memory.ts';
import type { Pipelines, StageDefinition } from '../gpu/pipelines.ts';
import { loadSplats } from '../io/load-splats.ts';
import type { ReadOptions } from '../io/splat-source.ts';
import { SHADER_CONSTANTS } from '../layout/constants.ts';
import { RepackParameters } from '../layout/structs.ts';
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
import { isGeometryAsFine, isShAsFine, type Plane } from './cloud-planes.ts';
import type { CloudSource, SplatCloud } from './splat-cloud.ts';

export interface PlaneMakerContext {
  readonly device: GPUDevice;
  readonly memory: GpuMemory;
  readonly pipelines: Pipelines;
  readonly counting: Pick<Counting, 'uploadedBytes'>;
  readonly dispatchRow: number;
  /** Why nothing can be made any more, or null. */
  readonly destroyedBecause: () => string | null;
  /** Compiles what draws the cloud at another precision wherever it is shown. */
  readonly compileFor: (cloud: SplatCloud, precision: CloudPrecision) => Promise<void>;
}

type RepackStage = StageDefinition<'parameters' | 'finer' | 'coarser'>;

/** What a request takes, each part null where it takes none. */
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
  /** Settled when nobody reads the sources of a cloud any more. */
  readonly #readings = new WeakMap<SplatCloud, Promise<unknown>>();

  constructor(context: PlaneMakerContext) {
    this.#context = context;
  }

  /**
   * Adds the planes of `wanted` to those that `cloud` holds, all at once. See `SplatCloud.hold` for what it rejects with;
   * everything is as it was then.
   */
  async make(cloud: SplatCloud, wanted: CloudPrecision, options: MakeOptions): Promise<void> {
    if (await this.#makeFrom(null, cloud, wanted, options)) return;
    // Sources are read in turn, since the second request for a precision finds what the first has made. What needs no
    // reading waits for nobody.
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

  /** @returns false, and makes nothing, where what the cloud holds and `fresh` are too coarse. */
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
    // Before the planes change: what draws the old ones cannot draw the new.
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
    // At once from here on: whoever comes next counts on what it finds held.
    for (const { adopt } of made) adopt();
    return true;
  }

  /** Uploads and repacks; what it creates is listed in `made` at once, so that it can be freed. */
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
      geometry = keepGeometry(freshGeometry.precision, planes.uploadGeometry(freshGeometry));
    }
    if (freshSh) {
      sh = keepSh(freshSh.precision, planes.uploadSh(freshSh));
    }
    if (geometryStage) {
      const coarser = keepGeometry(wanted.geometryPrecision, planes.createGeometry(wanted.geometryPrecision));
      this.#repack(cloud, geometryStage, geometry, coarser);
    }
    if (shStage) {
      const coarser = keepSh(wanted.shPrecision, planes.createSh(wanted.shPrecision));
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
        const contents = new ArrayBuffer(RepackParameters.bytes);
        RepackParameters.write(contents, { logScales, splatCount, dispatchRow });
        const usage = GPUBufferUsage.UNIFORM | GPUBufferUsage.COPY_DST;
        const parameters = memory.createBuffer('repack parameters', RepackParameters.bytes, usage);
        made.push(parameters);
        device.queue.writeBuffer(parameters, 0, contents);
        const bindings = { parameters, finer: finer[page], coarser: coarser[page] };
        pass.setBindGroup(0, pipelines.bindGroup(stage, bindings));
        const workgroups = Math.ceil(splatCount / SHADER_CONSTANTS.REPACK_WORKGROUP);
        pass.dispatchWorkgroups(...dispatchSize(workgroups, dispatchRow));
      }
      pass.end();
      device.queue.submit([encoder.finish()]);
    } finally {
      for (const buffer of made) memory.destroy(buffer);
    }
  }

  /** @throws GpuLimitError where what `make` makes does not fit into the GPU's memory. */
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
    // A buffer that cannot be mapped for its contents makes its creation throw instead.
    if (lacking || thrown instanceof RangeError) {
      const message = `${name} does not fit into the GPU's memory with ${describe(wanted)} (${neededBytes} bytes more); it stays as it was. Ask for a coarser precision.`;
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

/** The precision to read so that `wanted` can be made of it and of what `cloud` holds. */
function missingOf(
  { planes }: SplatCloud,
  { geometryPrecision, shPrecision }: CloudPrecision,
): CloudPrecision {
  const { geometry, sh } = planes.held;
  // Of what is not missing as little as can be: at degree 3 the finest harmonics take four times the memory.
  return {
    geometryPrecision: isGeometryAsFine(geometry[0], geometryPrecision) ? 'packed' : geometryPrecision,
    shPrecision: isShAsFine(sh[0], shPrecision) ? 'u8' : shPrecision,
  };
}

/** What it takes until `cloud` holds `wanted`; null where what it holds and `fresh` are too coarse. */
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
  // From the finest there is, so that nothing is rounded twice that need not be.
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

/** What `work` allocates. */
function bytesOf({ count, shDegree }: SplatCloud, wanted: CloudPrecision, work: Work): number {
  const geometryWords = work.geometryStage ? GEOMETRY_WORDS[wanted.geometryPrecision] : 0;
  const shWords = work.shStage ? shWordsPerSplat(shDegree, wanted.shPrecision) : 0;
  return uploadedBytes(work) + 4 * count * (geometryWords + shWords);
}

/** The splats of `cloud`, as fine as `wanted` or finer, and sure to be the same ones, of the first source that has them. */
async function readAgain(
  cloud: SplatCloud,
  wanted: CloudPrecision,
  options: MakeOptions,
): Promise<PackedCloud> {
  const { sources, name } = cloud;
  const gone = `a finer precision has to be read again (${describe(wanted)}), and what it was read from is gone; load it from a URL, a File or a Blob, or name its source when adding it.`;
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
      `its source has ${has} and cannot give ${describe(wanted)}; load it for that, or from a URL, a File or a Blob.`,
    );
  }
  if (!isSameSplats(cloud, fresh)) {
    const message = `there are other splats now than when it was loaded (${fresh.count}, then ${cloud.count}); it stays as it was. Load it anew to see them.`;
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
 * By the rows that were kept, their order, and the bounds of every chunk: places and sizes. Colours may be others, as
 * what is held of them is too coarse to tell.
 */
function isSameSplats(cloud: SplatCloud, fresh: PackedCloud): boolean {
  return (
    cloud.count === fresh.count &&
    cloud.shDegree === fresh.harmonics.degree &&
    cloud.origin.every((value, axis) => value === fresh.origin[axis]) &&
    cloud.logScaleRange.min === fresh.geometry.logScaleRange.min &&
    cloud.logScaleRange.step === fresh.geometry.logScaleRange.step &&
    isSameWords(cloud.fileIndices, fresh.fileIndices) &&
    isSameWords(new Uint32Array(cloud.chunks), new Uint32Array(fresh.chunks))
  );
}

function isSameWords(a: Uint32Array, b: Uint32Array): boolean {
  if (a.length !== b.length) return false;
  for (let i = 0; i < a.length; i++) if (a[i] !== b[i]) return false;
  return true;
}

function whenAborted(signal: AbortSignal): Promise<void> {
  return new Promise((resolve) => signal.addEventListener('abort', () => resolve(), { once: true }));
}
