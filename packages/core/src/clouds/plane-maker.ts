import { DestroyedError, GpuLimitError } from '../data/errors.ts';
import { CHUNK_SPLATS } from '../data/layout/constants.ts';
import { RepackParameters } from '../data/layout/packing-structs.ts';
import { GEOMETRY_WORDS } from '../data/packing/geometry.ts';
import { type CloudPrecision, ownShPrecision, type ShPrecision } from '../data/packing/precision.ts';
import { shPlaneBytes } from '../data/packing/sh-plane-bytes.ts';
import type { Counting } from '../gpu/engine-counters.ts';
import type { StageDefinition } from '../gpu/pipelines.ts';
import { type RepackShVariant, repackGeometry, repackSh } from '../stages/repack/repack.ts';
import { writerOf } from './cloud-feature.ts';
import type { MakeOptions } from './cloud-leases.ts';
import { type CloudPlanes, isGeometryAsFine, isShAsFine, type Plane } from './cloud-planes.ts';
import { createGeometry, createHarmonics } from './create-plane.ts';
import { type DispatchContext, Dispatches } from './ingest/dispatches.ts';
import { describePrecision, type FreshPlanes, type OpenRowPlanes, readAgain } from './read-again.ts';
import type { SplatCloud } from './splat-cloud.ts';

export interface PlaneMakerContext extends DispatchContext {
  readonly counting: Pick<Counting, 'uploadedBytes'>;
  /** Reason why no more planes can be made; null if they can. */
  readonly destroyedBecause: () => string | null;
  /**
   * Compiles the pipelines that draw the cloud with this precision, in every view that draws it.
   */
  readonly compileFor: (cloud: SplatCloud, precision: CloudPrecision) => Promise<void>;
  readonly openRowPlanes: OpenRowPlanes;
}

/** The steps to serve a request; null steps are not needed. */
interface Work {
  /** Planes that were read again, to take over. */
  readonly freshGeometry: FreshPlanes | null;
  readonly freshSh: FreshPlanes | null;
  readonly geometryStage: StageDefinition | null;
  readonly shStage: StageDefinition | null;
}

/** A plane that no cloud owns yet. */
interface MadePlane {
  readonly plane: Plane;
  readonly adopt: () => void;
}

/** Makes the planes that leases of clouds claim. */
export class PlaneMaker {
  readonly #context: PlaneMakerContext;
  /** Per cloud: settles when no request reads its sources. */
  readonly #readings = new WeakMap<SplatCloud, Promise<unknown>>();

  constructor(context: PlaneMakerContext) {
    this.#context = context;
  }

  /**
   * Adds the planes of `wanted` to `cloud`, all at once. Rejects with the errors that
   * `SplatCloud.hold` lists; nothing changes then.
   */
  async make(cloud: SplatCloud, wanted: CloudPrecision, options: MakeOptions): Promise<void> {
    if (await this.#makeFrom(null, cloud, wanted, options)) return;
    // Requests read sources in turn, because the second request for a precision finds the planes
    // that the first has made. Requests that need no reading do not wait.
    const earlier = this.#readings.get(cloud);
    const reading = this.#readAndMake(earlier, cloud, wanted, options);
    // Each request rejects with its own error.
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
    let fresh: FreshPlanes | null = null;
    try {
      while (!(await this.#makeFrom(fresh, cloud, wanted, options))) {
        fresh?.destroy();
        fresh = await this.#read(cloud, wanted, options);
      }
    } finally {
      fresh?.destroy();
    }
  }

  async #read(cloud: SplatCloud, wanted: CloudPrecision, options: MakeOptions): Promise<FreshPlanes> {
    try {
      return await readAgain(cloud, missingOf(cloud, wanted), this.#context.openRowPlanes, options);
    } catch (error) {
      // The error may only follow from the end of the engine or the device, which is reported
      // instead.
      this.#checkUsable(options.signal);
      throw isLack(error) ? memoryError(cloud, wanted, error.neededBytes, error) : error;
    }
  }

  /** @returns false, without making anything, if the cloud's planes and `fresh` are too coarse. */
  async #makeFrom(
    fresh: FreshPlanes | null,
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
    const shPrecision = cloud.planes.storedAs(wanted.shPrecision);
    await this.#context.compileFor(cloud, { ...wanted, shPrecision });
    this.#checkUsable(signal);
    // Another claim may have been met or released while shaders compiled.
    if (cloud.planes.held !== held) return this.#makeFrom(fresh, cloud, wanted, { signal });
    const made: MadePlane[] = [];
    let edit: (() => void) | undefined;
    try {
      await this.#withMemoryFor(cloud, wanted, bytesOf(cloud, wanted, work), () =>
        this.#make(cloud, wanted, work, made),
      );
      // Planes just read lack edits. Without edits no await follows, so that none can arrive
      // meanwhile.
      const writer = writerOf(cloud);
      if (work.freshGeometry && writer)
        edit = await writer.rebase!(work.freshGeometry.geometryPrecision, made[0].plane);
      this.#checkUsable(signal);
    } catch (error) {
      for (const { plane } of made) cloud.planes.free(plane);
      throw error;
    }
    // Synchronous from here on, because the next request relies on the planes that it finds.
    for (const { adopt } of made) adopt();
    edit?.();
    return true;
  }

  /**
   * Uploads and repacks. Each plane is added to `made` at once, so that the caller can free it on
   * failure.
   */
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
      geometry = keepGeometry(freshGeometry.geometryPrecision, freshGeometry.takeGeometry());
    }
    if (freshSh) {
      sh = keepSh(freshSh.shPrecision, freshSh.takeHarmonics());
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
        createHarmonics(planes.place, planes.shDegree, ownShPrecision(wanted.shPrecision)),
      );
      this.#repack(cloud, shStage, sh, coarser);
    }
    this.#context.counting.uploadedBytes += freshBytes(cloud, work);
  }

  #repack({ planes }: SplatCloud, stage: StageDefinition, finer: Plane, coarser: Plane): void {
    const { dispatchRow } = this.#context;
    const dispatches = new Dispatches(this.#context);
    for (const [page, { start, end }] of planes.ranges.entries()) {
      const splatCount = end - start;
      const parameters = RepackParameters.pack({ splatCount, dispatchRow });
      const bindings = { finer: finer[page], coarser: coarser[page], chunks: planes.chunksPlane[page] };
      dispatches.add(stage, parameters, bindings, Math.ceil(splatCount / CHUNK_SPLATS));
    }
    dispatches.submit(stage.stage);
  }

  /** Calls `make`. @throws GpuLimitError if its buffers exceed the GPU's memory. */
  async #withMemoryFor(
    cloud: SplatCloud,
    wanted: CloudPrecision,
    neededBytes: number,
    make: () => void,
  ): Promise<void> {
    try {
      await this.#context.memory.guard(cloud.name, '', make).checked;
    } catch (error) {
      throw isLack(error) ? memoryError(cloud, wanted, neededBytes, error) : error;
    }
  }

  #checkUsable(signal: AbortSignal): void {
    signal.throwIfAborted();
    const reason = this.#context.destroyedBecause();
    if (reason !== null) throw new DestroyedError('This request', reason);
  }
}

function isLack(error: unknown): error is GpuLimitError {
  return error instanceof GpuLimitError && error.limit === 'memory';
}

function memoryError(
  { name }: SplatCloud,
  wanted: CloudPrecision,
  neededBytes: number,
  cause: GpuLimitError,
): GpuLimitError {
  const message = `${name} does not fit into the GPU's memory with ${describePrecision(wanted)} (${neededBytes} bytes more); it is unchanged. Request a coarser precision.`;
  const { heldBytes } = cause;
  return new GpuLimitError('memory', neededBytes, 0, message, { heldBytes, cause });
}

/** Returns the precision to read, so that it and the planes of `cloud` suffice for `wanted`. */
function missingOf(
  { planes }: SplatCloud,
  { geometryPrecision, shPrecision }: CloudPrecision,
): CloudPrecision {
  const { geometry, sh } = planes.held;
  // The other plane is read as coarsely as possible: the finest harmonics take four times the
  // memory.
  return {
    geometryPrecision: isGeometryAsFine(geometry[0], geometryPrecision) ? 'packed' : geometryPrecision,
    shPrecision: needsPalette(planes, shPrecision) || !isShAsFine(sh[0], shPrecision) ? shPrecision : 'u8',
  };
}

/** Whether a palette must be read again, because palettes are built on the CPU. */
function needsPalette(planes: CloudPlanes, shPrecision: ShPrecision): boolean {
  return shPrecision === 'palette' && !planes.shPlane('palette');
}

/**
 * Returns the steps until `cloud` holds `wanted`; null if its planes and `fresh` are too coarse.
 */
function workFor(
  { planes, shDegree }: SplatCloud,
  { geometryPrecision, shPrecision }: CloudPrecision,
  fresh: FreshPlanes | null,
): Work | null {
  const [finestGeometry] = planes.held.geometry;
  const [finestSh] = planes.held.sh;
  const freshGeometry = fresh && !isGeometryAsFine(finestGeometry, geometryPrecision) ? fresh : null;
  const isPaletteMissing = needsPalette(planes, shPrecision);
  const freshSh = fresh && (isPaletteMissing || !isShAsFine(finestSh, shPrecision)) ? fresh : null;
  const isFineEnough =
    isGeometryAsFine(freshGeometry?.geometryPrecision ?? finestGeometry, geometryPrecision) &&
    isShAsFine(freshSh?.shPrecision ?? finestSh, shPrecision) &&
    (!isPaletteMissing || freshSh?.shPrecision === 'palette');
  if (!isFineEnough) return null;
  const hasGeometry =
    planes.geometryPlane(geometryPrecision) || freshGeometry?.geometryPrecision === geometryPrecision;
  const hasSh = planes.shPlane(shPrecision) || freshSh?.shPrecision === shPrecision;
  // Repacked from the finest available precision, to avoid rounding twice.
  const from = (freshSh?.shPrecision ?? finestSh) as RepackShVariant['from'];
  return {
    freshGeometry,
    freshSh,
    geometryStage: hasGeometry ? null : repackGeometry,
    shStage: hasSh ? null : repackSh({ degree: shDegree, from, to: shPrecision as RepackShVariant['to'] }),
  };
}

/** Bytes of planes that were read again. */
function freshBytes({ count, shDegree }: SplatCloud, { freshGeometry, freshSh }: Work): number {
  const geometryWords = freshGeometry ? GEOMETRY_WORDS[freshGeometry.geometryPrecision] : 0;
  const shBytes = freshSh ? shPlaneBytes(count, shDegree, freshSh.shPrecision, freshSh.paletteEntries) : 0;
  return 4 * count * geometryWords + shBytes;
}

/** Bytes of the planes that `work` adds. */
function bytesOf(cloud: SplatCloud, wanted: CloudPrecision, work: Work): number {
  const { count, shDegree } = cloud;
  const geometryWords = work.geometryStage ? GEOMETRY_WORDS[wanted.geometryPrecision] : 0;
  const shBytes = work.shStage ? shPlaneBytes(count, shDegree, wanted.shPrecision) : 0;
  return freshBytes(cloud, work) + 4 * count * geometryWords + shBytes;
}

function whenAborted(signal: AbortSignal): Promise<void> {
  return new Promise((resolve) => signal.addEventListener('abort', () => resolve(), { once: true }));
}
