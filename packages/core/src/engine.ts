import {
  type Accuracy,
  type AccuracySettings,
  DEFAULT_ACCURACY,
  internAccuracy,
  type PossibleAccuracy,
} from './accuracy/accuracy.ts';
import { type AccuracyRequest, type AccuracyWish, internWish } from './accuracy/accuracy-wish.ts';
import type { HoldOptions } from './clouds/cloud-leases.ts';
import type { HeldPrecisions } from './clouds/cloud-planes.ts';
import type { PlaneMaker } from './clouds/plane-maker.ts';
import { type CloudSource, SplatCloud } from './clouds/splat-cloud.ts';
import { DestroyedError } from './errors.ts';
import { frameStages } from './frame/frame.ts';
import type { FrameShape } from './frame/frame-shape.ts';
import { adapterLabel, type DeviceOptions, requestSplatDevice } from './gpu/device.ts';
import { type EngineCounters, zeroCounters } from './gpu/engine-counters.ts';
import { GpuMemory, type GpuMemoryReport } from './gpu/gpu-memory.ts';
import { Pipelines } from './gpu/pipelines.ts';
import { lastingSource, loadSplats } from './io/load-splats.ts';
import { sourceName } from './io/open-source.ts';
import type { ReadOptions, SplatSource } from './io/splat-source.ts';
import type { EffectEntry } from './ledger/ledger.ts';
import type { AccuracyChoice } from './measure/choose-accuracy.ts';
import type { Harmonics } from './packing/harmonics.ts';
import { packSet } from './packing/pack-set.ts';
import type { PackedCloud } from './packing/packed-cloud.ts';
import type { CloudPrecision } from './packing/precision.ts';
import type { ShaderMutation } from './shaders/link-shader.ts';
import type { SplatSet } from './splats/splat-set.ts';
import { AccuracyWishes } from './views/accuracy-wishes.ts';
import { EmbeddedView } from './views/embedded-view.ts';
import { SplatView } from './views/splat-view.ts';
import type { ViewContext } from './views/view-core.ts';

export interface EngineOptions extends DeviceOptions {
  /** A device to work on; by default one is made, with all that its adapter offers. */
  readonly device?: GPUDevice;
  /** Settings, or a wish: see `SplatView.onAccuracyChosen`. Default `balanced`. */
  readonly accuracy?: AccuracyRequest;
  /** Most workgroups in one dimension of a dispatch; by default the device's limit. For tests of large dispatches. */
  readonly maxWorkgroupsPerDimension?: number;
  /** @internal For tests alone: see ShaderMutation. */
  readonly mutation?: ShaderMutation;
}

/** A cloud that could not be given the precision of the engine's accuracy, and why. */
export interface PrecisionProblem {
  readonly cloud: SplatCloud;
  /** As `requestPrecision` rejects with it. */
  readonly error: Error;
}

/** Draws Gaussian splats on one WebGPU device. */
export class SplatEngine {
  readonly device: GPUDevice;
  /** What a person would call the adapter. */
  readonly adapterLabel: string;
  /** Whether stages are timed by the GPU itself. */
  readonly hasGpuTimestamps: boolean;
  /** Resolves when the device is lost, on purpose or not. */
  readonly lost: Promise<GPUDeviceLostInfo>;
  readonly #counting = zeroCounters();
  readonly #memory: GpuMemory;
  readonly #pipelines: Pipelines;
  readonly #ownsDevice: boolean;
  readonly #dispatchRow: number;
  #planeMaker: Promise<PlaneMaker> | null = null;
  readonly #wishes: AccuracyWishes;
  readonly #views = new Set<SplatView | EmbeddedView>();
  readonly #clouds = new Set<SplatCloud>();
  /** By what was asked for: what this device does of it. */
  readonly #possible = new WeakMap<AccuracySettings, PossibleAccuracy>();
  /** What frames wish that do not say otherwise, or null. */
  #wish: AccuracyWish | null = null;
  #accuracy: PossibleAccuracy = { settings: internAccuracy(), notices: [] };
  #destroyedBecause: string | null = null;

  private constructor(device: GPUDevice, ownsDevice: boolean, options: EngineOptions) {
    this.device = device;
    this.adapterLabel = adapterLabel(device.adapterInfo);
    this.hasGpuTimestamps = device.features.has('timestamp-query');
    this.#memory = new GpuMemory(device);
    this.#pipelines = new Pipelines(device, options.mutation, this.#counting);
    this.#ownsDevice = ownsDevice;
    const limit = device.limits.maxComputeWorkgroupsPerDimension;
    this.#dispatchRow = Math.min(options.maxWorkgroupsPerDimension ?? limit, limit);
    this.#wishes = new AccuracyWishes({
      measure: async (wish, picture, options) => {
        // Most pages wish for nothing.
        const { measureWish } = await import('./measure/measure-wish.ts');
        return measureWish(this, wish, picture, options);
      },
      adopt: (choice, clouds) => this.#adopt(choice, clouds),
    });
    this.#takeAccuracy(options.accuracy ?? DEFAULT_ACCURACY);
    this.lost = device.lost.then((info) => {
      this.#destroyedBecause ??= `the GPU device was lost (${info.message || info.reason})`;
      this.#stopWork(this.#destroyedBecause);
      return info;
    });
  }

  /**
   * An engine on `options.device`, or on a device of its own.
   *
   * @throws WebGpuUnavailableError where there is no WebGPU, InvalidArgumentError for unknown accuracy settings.
   */
  static async create(options: EngineOptions = {}): Promise<SplatEngine> {
    // Before a device is made for nothing.
    const { accuracy = DEFAULT_ACCURACY } = options;
    if (!internWish(accuracy)) internAccuracy(accuracy as Accuracy);
    const device = options.device ?? (await requestSplatDevice(options));
    return new SplatEngine(device, options.device === undefined, options);
  }

  /**
   * What frames are drawn with that do not say otherwise, and what clouds are loaded for. Under a wish what was chosen for it
   * last, `balanced` before that; a view that shows other clouds may have a choice of its own.
   */
  get accuracy(): AccuracySettings {
    return this.#accuracy.settings;
  }

  /** What the device could not do of `accuracy` as asked, in words. */
  get notices(): readonly string[] {
    return this.#accuracy.notices;
  }

  /**
   * Changes `accuracy`: views draw with it from their next frame on, at first from what their clouds hold. Each cloud is
   * asked for its precisions, as by `requestPrecision`; where that fails it stays as it is. For a wish that happens when it
   * has been chosen: see `SplatView.onAccuracyChosen`.
   *
   * @returns when all clouds hold what they can: those that do not hold what was asked for. Never rejects; a later change
   *   takes the place of this one.
   * @throws InvalidArgumentError for unknown settings; everything stays as it was then.
   */
  setAccuracy(accuracy: AccuracyRequest): Promise<readonly PrecisionProblem[]> {
    this.#checkUsable();
    this.#takeAccuracy(accuracy);
    // What a wish will need is not known before it has been measured.
    return this.#askForPrecision(this.#wish ? [] : [...this.#clouds]);
  }

  /**
   * The settings that come closest to `accuracy` on this device, default the engine's own, and in words what had to give
   * way. Equal settings are one object.
   *
   * @throws InvalidArgumentError for unknown settings.
   */
  resolveAccuracy(accuracy?: Accuracy): PossibleAccuracy {
    if (accuracy === undefined) return this.#accuracy;
    const asked = internAccuracy(accuracy);
    const possible = this.#possible.get(asked) ?? possibleOn(this.device, asked);
    this.#possible.set(asked, possible);
    return possible;
  }

  /**
   * Reads splats, in a worker where there are any, and uploads them. Addresses, Files and Blobs are kept as handles, so
   * that `requestPrecision` can read them again.
   *
   * @throws SplatFileError, SplatSourceError, GpuLimitError; the signal's reason where it aborts. Nothing is kept then.
   */
  async load(source: SplatSource, options: ReadOptions = {}): Promise<SplatCloud> {
    this.#checkUsable();
    const { accuracy } = this;
    const { geometryPrecision, shPrecision } = accuracy;
    const packed = await loadSplats(source, { ...options, geometryPrecision, shPrecision });
    const cloud = this.addPacked(packed, {
      name: options.name ?? sourceName(source),
      source: lastingSource(source),
    });
    if (accuracy !== this.accuracy) void this.#askForPrecision([cloud]);
    return cloud;
  }

  /**
   * Packs and uploads splats that are in memory already, in any order; what is not finite is left out and counted. The
   * cloud keeps `set` by reference, for `requestPrecision`.
   */
  add(set: SplatSet<Harmonics>, options: { readonly name?: string } = {}): SplatCloud {
    return this.addPacked(packSet(set, this.accuracy), { ...options, source: set });
  }

  /**
   * Uploads what `packCloud` made, on this thread or another, packed for whatever accuracy: frames draw what there is.
   *
   * @param options.source where `requestPrecision` can have the same splats again: what they were read from, or, where
   *   the memory that it takes is there anyway, `packed` itself. Of several the first that is fine enough is taken: list
   *   what is cheap to read first. Kept by reference; by default nothing is kept.
   * @throws GpuLimitError.
   */
  addPacked(
    packed: PackedCloud,
    options: { readonly name?: string; readonly source?: CloudSource | readonly CloudSource[] | null } = {},
  ): SplatCloud {
    this.#checkUsable();
    const counting = this.#counting;
    const name = options.name ?? 'splats';
    const cloud = new SplatCloud(this.#memory, this.device.limits, packed, {
      name,
      source: options.source,
      makePlanes: (...request) => this.#makePlanes(...request),
      onDestroyed: (destroyed) => {
        counting.cloudsDestroyed++;
        this.#clouds.delete(destroyed);
        this.#wishes.stop(new DestroyedError(`The cloud ${name}`, 'it was destroyed'), destroyed);
      },
    });
    this.#clouds.add(cloud);
    counting.uploads++;
    counting.uploadedBytes += cloud.bytes;
    return cloud;
  }

  /**
   * Makes the cloud's own lease claim this precision, and so frees what only that lease claimed before: see `cloud.hold`. A
   * later request for the cloud takes the place of this one.
   *
   * @throws what the `met` of a lease rejects with.
   */
  async requestPrecision(
    cloud: SplatCloud,
    precision: CloudPrecision,
    options: HoldOptions = {},
  ): Promise<void> {
    this.#checkUsable();
    await cloud.ownLease.change(precision, options);
  }

  /** A view that draws on `canvas`, or one whose pictures are read back. */
  createView(options: { readonly canvas?: HTMLCanvasElement | OffscreenCanvas } = {}): SplatView {
    this.#checkUsable();
    const format = globalThis.navigator?.gpu?.getPreferredCanvasFormat() ?? 'rgba8unorm';
    const forget = (destroyed: SplatView) => this.#views.delete(destroyed);
    const view = new SplatView(this.#viewContext(), options.canvas ?? null, format, forget);
    this.#views.add(view);
    return view;
  }

  /** A view inside the frames of another renderer on the same device. */
  createEmbeddedView(): EmbeddedView {
    this.#checkUsable();
    const view = new EmbeddedView(this.#viewContext(), (destroyed) => this.#views.delete(destroyed));
    this.#views.add(view);
    return view;
  }

  /** See `SplatView.effects`: those of the view that was drawn last. */
  effects(): readonly EffectEntry[] {
    const [last] = [...this.#views].toSorted((a, b) => b.drawnAs - a.drawnAs);
    return last?.effects() ?? [];
  }

  /** What the engine holds on the GPU at this moment. */
  memory(): GpuMemoryReport {
    return this.#memory.report();
  }

  /** What the engine has done so far. */
  counters(): EngineCounters {
    return { ...this.#counting };
  }

  /** Frees everything that the engine made, the device too where it made it. */
  destroy(): void {
    if (this.#destroyedBecause === 'the engine was destroyed') return;
    this.#destroyedBecause = 'the engine was destroyed';
    this.#stopWork(this.#destroyedBecause);
    for (const view of [...this.#views]) view.destroy();
    this.#memory.destroyAll();
    if (this.#ownsDevice) this.device.destroy();
  }

  #takeAccuracy(request: AccuracyRequest): void {
    const wish = internWish(request);
    const accuracy = wish ? (this.#wishes.latest(wish)?.settings ?? DEFAULT_ACCURACY) : (request as Accuracy);
    this.#accuracy = this.resolveAccuracy(accuracy);
    if (this.#wish && this.#wish !== wish) this.#wishes.withdraw(this.#wish);
    this.#wish = wish;
  }

  /** Makes what was chosen for a wish the engine's own where the wish is, and frees what nothing is drawn with any more. */
  async #adopt(choice: AccuracyChoice, clouds: readonly SplatCloud[]): Promise<void> {
    const { wish, settings } = choice;
    if (wish === this.#wish) this.#accuracy = this.resolveAccuracy(settings);
    const others = [...this.#views].filter(({ accuracyChoice }) => accuracyChoice !== choice);
    const requests = clouds.map((cloud) => {
      const isShared = others.some(({ shape }) => shape !== null && asksOtherwise(shape, cloud, settings));
      const { ownLease } = cloud;
      const met = isShared ? ownLease.add(settings) : ownLease.change(settings);
      // What cannot be had was not measured either: the table says so.
      return met.catch(() => {});
    });
    await Promise.all(requests);
  }

  /** Asks for the precisions of `accuracy`; answers with those that cannot have them, but not with what was called off. */
  async #askForPrecision(clouds: readonly SplatCloud[]): Promise<PrecisionProblem[]> {
    const { accuracy } = this;
    const outcomes = clouds.map((cloud) =>
      this.requestPrecision(cloud, accuracy).then(
        () => null,
        (error: Error) => ({ cloud, error }),
      ),
    );
    const problems = (await Promise.all(outcomes)).filter((problem) => problem !== null);
    return problems.filter(({ error }) => error.name !== 'AbortError' && !(error instanceof DestroyedError));
  }

  #viewContext(): ViewContext {
    return {
      device: this.device,
      pipelines: this.#pipelines,
      memory: this.#memory,
      counting: this.#counting,
      wishFor: (asked) => (asked === undefined ? this.#wish : internWish(asked)),
      accuracyFor: (asked) => this.resolveAccuracy(asked).settings,
      wishes: this.#wishes,
      dispatchRow: this.#dispatchRow,
      destroyedBecause: () => this.#destroyedBecause,
    };
  }

  #stopWork(because: string): void {
    for (const { leases } of this.#clouds) leases.end(new DestroyedError('This request', because));
    this.#wishes.stop(new DestroyedError('This measurement', because));
  }

  async #makePlanes(...request: Parameters<PlaneMaker['make']>): Promise<void> {
    const [cloud, wanted, { signal }] = request;
    const { planes } = cloud;
    // Most claims are for planes that were uploaded: nothing is loaded for those.
    while (isHeld(planes.held, wanted)) {
      const { held } = planes;
      await this.#compileFor(cloud, wanted);
      signal.throwIfAborted();
      this.#checkUsable();
      if (planes.held === held) return;
    }
    this.#planeMaker ??= this.#loadPlaneMaker();
    await (await this.#planeMaker).make(...request);
  }

  async #loadPlaneMaker(): Promise<PlaneMaker> {
    const { PlaneMaker } = await import('./clouds/plane-maker.ts');
    return new PlaneMaker({
      device: this.device,
      memory: this.#memory,
      pipelines: this.#pipelines,
      counting: this.#counting,
      dispatchRow: this.#dispatchRow,
      destroyedBecause: () => this.#destroyedBecause,
      compileFor: (cloud, precision) => this.#compileFor(cloud, precision),
    });
  }

  /** Where it fails, the frame that needs it says so. */
  async #compileFor(cloud: SplatCloud, precision: CloudPrecision): Promise<void> {
    const stages = [...this.#views].flatMap(({ shape }) => {
      if (!shape?.clouds.some((each) => each.cloud === cloud)) return [];
      const clouds = shape.clouds.map((each) =>
        each.cloud === cloud ? { ...each, planes: { ...each.planes, ...precision } } : each,
      );
      return frameStages({ ...shape, clouds });
    });
    await this.#pipelines.prepare(stages).catch(() => {});
  }

  #checkUsable(): void {
    if (this.#destroyedBecause !== null) throw new DestroyedError('This engine', this.#destroyedBecause);
  }
}

/** Whether a picture that shows `cloud` asks for other precisions of it. */
function asksOtherwise({ clouds, accuracy }: FrameShape, cloud: SplatCloud, asked: CloudPrecision): boolean {
  const { geometryPrecision, shPrecision } = accuracy;
  const isSame = geometryPrecision === asked.geometryPrecision && shPrecision === asked.shPrecision;
  return clouds.some((each) => each.cloud === cloud) && !isSame;
}

function possibleOn(device: GPUDevice, asked: AccuracySettings): PossibleAccuracy {
  if (asked.colorTarget === 'rgba32float' && !device.features.has('float32-blendable' as GPUFeatureName)) {
    const notice =
      'This device cannot blend rgba32float (float32-blendable); pictures are blended in rgba16float.';
    return { settings: internAccuracy({ ...asked, colorTarget: 'rgba16float' }), notices: [notice] };
  }
  return { settings: asked, notices: [] };
}

function isHeld(
  { geometry, sh }: HeldPrecisions,
  { geometryPrecision, shPrecision }: CloudPrecision,
): boolean {
  return geometry.includes(geometryPrecision) && sh.includes(shPrecision);
}
