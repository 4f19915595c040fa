import { checkLoadOptions } from './check-options.ts';
import type { HoldOptions } from './clouds/cloud-leases.ts';
import { type CloudMemory, isHeld } from './clouds/cloud-planes.ts';
import { emptyCloud } from './clouds/empty-cloud.ts';
import type { CloudFit, FitMode } from './clouds/fit-settings.ts';
import type { DispatchContext } from './clouds/ingest/dispatches.ts';
import { LazyIngest } from './clouds/ingest/lazy-ingest.ts';
import type { IngestedCloud, RowIngestOptions } from './clouds/ingest/row-ingest.ts';
import type { CloudLevels } from './clouds/levels/cloud-levels.ts';
import type { PlaneMaker } from './clouds/plane-maker.ts';
import { type CloudSource, SplatCloud, type SplatCloudOptions } from './clouds/splat-cloud.ts';
import { loadStreamed } from './clouds/stream/load-streamed.ts';
import type { StreamContext, StreamOptions, StreamShares } from './clouds/stream/stream-budget.ts';
import {
  type Accuracy,
  type AccuracySettings,
  DEFAULT_ACCURACY,
  type FrameRasterizer,
  internAccuracy,
  type PossibleAccuracy,
} from './data/accuracy/accuracy.ts';
import { type AccuracyRequest, type AccuracyTarget, internTarget } from './data/accuracy/accuracy-target.ts';
import type { BrickScene } from './data/bricks/brick.ts';
import { DestroyedError, fetched, GpuLimitError } from './data/errors.ts';
import { CLOUD, given } from './data/given.ts';
import { callListener } from './data/listeners.ts';
import type { Harmonics } from './data/packing/harmonics.ts';
import { packSet } from './data/packing/pack-set.ts';
import type { PackedCloud } from './data/packing/packed-cloud.ts';
import { checkPacked } from './data/packing/packed-cloud.ts';
import type { CloudPrecision } from './data/packing/precision.ts';
import type { SplatSet } from './data/splats/splat-set.ts';
import type { GpuSplats, GpuSplatsOptions } from './features/gpu-splats/gpu-splats.clouds.ts';
import { frameStages } from './frame/frame-passes.ts';
import type { EffectEntry } from './frame/ledger/ledger.ts';
import { DEFAULT_TILE_BUDGET_BYTES } from './frame/parts/pair-capacity.ts';
import type { CloudShape, FrameShape } from './frame/plan/frame-shape.ts';
import { adapterLabel, type DeviceOptions, fasterBallots, isSoftwareAdapter } from './gpu/device.ts';
import type { EffectFaults } from './gpu/effects/cloud-effects.ts';
import { type EngineCounters, zeroCounters } from './gpu/engine-counters.ts';
import { GpuMemory, type GpuMemoryReport } from './gpu/gpu-memory.ts';
import { Pipelines } from './gpu/pipelines.ts';
import type { ShaderMutation } from './gpu/shaders/link-shader.ts';
import type { RowFiles } from './io/formats/rows/row-sink.ts';
import { loadOrPass } from './io/loading/load-splats.ts';
import { type KnownSource, knownSource, lastingOf } from './io/sources/known-source.ts';
import type { LoadProgress, ReadOptions, SourceOptions, SplatSource } from './io/sources/splat-source.ts';
import type { AccuracyChoice } from './measure/choose-accuracy.ts';
import { sortDeviceOf } from './stages/sort/sort.ts';
import { AccuracyTargets } from './views/accuracy-targets.ts';
import { EmbeddedView } from './views/embedded-view.ts';
import { rememberedRasterizer } from './views/remembered-rasterizer.ts';
import { SplatView } from './views/splat-view.ts';
import { DEFAULT_SUBMISSION_BUDGET_MS } from './views/submission-forecast.ts';
import { possibleOn } from './views/view-accuracy.ts';
import type { ViewContext } from './views/view-frames.ts';

/** How exactly a frame was drawn. */
export interface DrawnAccuracy {
  readonly settings: AccuracySettings;
  /**
   * Settings chosen for the view's target, with the reason in words. Null before the first choice,
   * and if settings were requested instead of a target.
   */
  readonly choice: AccuracyChoice | null;
  readonly rasterizer: FrameRasterizer;
  /** Why the view uses this rasteriser: a sentence for people. */
  readonly rasterizerReason: string;
}

/** Options of `SplatEngine.create`. */
export interface EngineOptions extends DeviceOptions {
  /** Device to draw on; by default the engine requests one of its own, see `requestSplatDevice`. */
  readonly device?: GPUDevice;
  /** Settings, or a target: see `SplatView.onAccuracyChosen`. Default `balanced`. */
  readonly accuracy?: AccuracyRequest;
  /**
   * Most bytes of GPU memory that the tile lists of one view may take; default 512 MiB. Frames that
   * need more use larger tiles, whose lists are shorter in total but take longer to draw. Quads draw
   * a frame if there is no room for one entry of 16 bytes per visible splat.
   */
  readonly tileBudgetBytes?: number;
  /**
   * Longest that one submission of a `SplatView`'s frame may keep the GPU, in milliseconds; default
   * 250. The page freezes while a submission runs, and the operating system resets a driver after
   * some seconds, two on Windows. A frame is submitted in parts if it was measured to take longer,
   * or if it has a cloud that the view has not drawn before. Each part is complete before the next;
   * the image is the same, and `whenDrawn` waits for it. Levels of detail are made in such parts
   * too. Hosts of an `EmbeddedView` make their own submissions. Infinity: never divide.
   */
  readonly submissionBudgetMs?: number;
  /**
   * Most bytes of GPU memory that the engine may hold, of clouds, views and work under way; default
   * no limit of its own. Anything beyond is refused with a GpuLimitError before it is allocated.
   */
  readonly memoryBudgetBytes?: number;
  /**
   * Advice in the message of a GpuLimitError if a buffer exceeds the limits of `device`, for hosts
   * that request the device themselves: a sentence that says how to raise them.
   */
  readonly limitAdvice?: string;
  /**
   * Most bytes of GPU memory for all streamed scenes together that are loaded without a
   * `budgetBytes` of their own; default 512 MiB. Each scene gets an equal share; unused parts of a
   * share go to the other scenes.
   */
  readonly streamBudgetBytes?: number;
}

/** Changes of an engine for tests, by `createEngine` of `@websplatter/core/inspect`. */
export interface EngineSeams {
  /** Most workgroups along an axis of a dispatch, 1 or more; default the device's limit. */
  readonly maxWorkgroupsPerDimension?: number;
  /**
   * Files with at least this many rows are packed on the GPU; default 65,536. Files that arrive
   * slowly are packed there at any size.
   */
  readonly ingestMinRows?: number;
  /** A fault in one shader. */
  readonly mutation?: ShaderMutation;
}

/** Smaller files are packed on the CPU before the shaders that pack on the GPU are compiled. */
const INGEST_MIN_ROWS = 1 << 16;
/** Bytes of a splat without harmonics. */
const LEAST_ROW_BYTES = 56;
/** Most captures have all harmonics. */
const LIKELY_SH_DEGREE = 3;
/** Few enough for a page to copy without a pause that a person would notice. */
const PIECE_BYTES = 4 << 20;

/** Options of `engine.load`. */
export interface LoadOptions extends ReadOptions {
  /**
   * GPU memory for a scene in bricks or a streamed SOG, at most; default a share of the engine's
   * `streamBudgetBytes`. Scenes that need less take less, and other scenes are loaded as a whole.
   */
  readonly budgetBytes?: number;
  /** Precision of planes; default: the engine's accuracy, even if it changes during the load. */
  readonly precision?: CloudPrecision;
  /**
   * Called again and again while a file arrives that is large or takes longer than half a second,
   * with a cloud of the splats read so far. Only binary PLYs of known size have previews.
   *
   * Show each preview instead of the one before, which is destroyed as soon as this returns. The
   * last preview looks like the cloud that `load` resolves with, and lasts as long as that cloud, or
   * until the load fails. Earlier previews show at most 786,432 visible splats, the first in the
   * file, so that loading takes no more memory than showing the cloud. Previews have no
   * `fileIndices`, are ignored by picks, refused by `makeRayTree`, and keep their precision.
   */
  readonly onPreview?: (preview: SplatCloud) => void;
  /**
   * Action where the cloud would not fit into the GPU's memory or the engine's budget. `exact`, the
   * default: the load fails with a GpuLimitError that names settings which would fit. `auto`: it
   * takes the finest of these, first coarser harmonics, then packed geometry, then fewer degrees of
   * harmonics, and `SplatCloud.fit` says which and why. Files that are not packed on the GPU keep
   * their geometry, and a cloud with fewer degrees cannot be given a finer precision later.
   */
  readonly fit?: FitMode;
}

interface NewCloudOptions {
  readonly name?: string;
  readonly source?: CloudSource | readonly CloudSource[] | null;
  readonly sourceOptions?: SourceOptions;
}

/** Options of the cloud that a load makes. */
type LoadedCloudOptions = NewCloudOptions & Pick<SplatCloudOptions, 'fit'>;

/**
 * GPU memory that an engine holds. The rest, beside scene and frames, belongs to work under way,
 * such as making planes or measuring.
 */
export interface EngineMemory extends GpuMemoryReport {
  /** Loaded clouds. */
  readonly scene: {
    readonly totalBytes: number;
    readonly clouds: readonly (CloudMemory & {
      readonly name: string;
      /** Bytes of levels of detail; undefined if the cloud has none. */
      readonly levelsBytes?: number;
    })[];
  };
  /** Memory of drawing; most of it follows the visible splats. */
  readonly frames: {
    readonly totalBytes: number;
    /** In the order in which the views were created. */
    readonly views: readonly GpuMemoryReport[];
  };
}

/** How `setAccuracy` gives clouds their precisions. */
export interface SetAccuracyOptions {
  /** Cancels changes of precision: clouds stay as they are. The accuracy stays as requested. */
  readonly signal?: AbortSignal;
  /** Called with the progress of each cloud whose source is read again. */
  readonly onProgress?: (progress: LoadProgress, cloud: SplatCloud) => void;
}

/** A cloud that could not be given the precision of the engine's accuracy, and why. */
export interface PrecisionProblem {
  readonly cloud: SplatCloud;
  /** The error that `requestPrecision` rejects with. */
  readonly error: Error;
}

/** Reaction of an engine to the loss of its device; null once the engine has ended. */
interface OnLoss {
  react: ((because: string) => void) | null;
}

/**
 * Resolves as `device.lost`, after the engine's reaction has run. A device keeps every handler of
 * `lost` in memory and may outlive many engines. An engine that ends therefore sets `react` to null,
 * so that the handler does not keep the engine alive.
 */
function lossOf(device: GPUDevice, onLoss: OnLoss): Promise<GPUDeviceLostInfo> {
  return device.lost.then((info) => {
    onLoss.react?.(`the GPU device was lost (${info.message || info.reason})`);
    return info;
  });
}

/** Draws Gaussian splats on one WebGPU device. Made by `SplatEngine.create`. */
export class SplatEngine {
  readonly device: GPUDevice;
  /** Human-readable name of the adapter. */
  readonly adapterLabel: string;
  /** Whether the GPU itself times the stages. */
  readonly hasGpuTimestamps: boolean;
  /** Resolves when the device is lost, on purpose or not. */
  readonly lost: Promise<GPUDeviceLostInfo>;
  readonly #counting = zeroCounters();
  readonly #memory: GpuMemory;
  readonly #pipelines: Pipelines;
  readonly #faults: EffectFaults = new WeakMap();
  readonly #ownsDevice: boolean;
  readonly #dispatchRow: number;
  readonly #tileBudgetBytes: number;
  readonly #submissionBudgetMs: number;
  readonly #ingestMinRows: number;
  readonly #streamShares: StreamShares;
  #planeMaker: Promise<PlaneMaker> | null = null;
  readonly #targets: AccuracyTargets;
  readonly #views = new Set<SplatView | EmbeddedView>();
  readonly #clouds = new Set<SplatCloud>();
  /** Requested settings → the closest settings that this device supports. */
  readonly #possible = new WeakMap<AccuracySettings, PossibleAccuracy>();
  /** The target of frames without an accuracy of their own, or null. */
  #target: AccuracyTarget | null = null;
  #accuracy: PossibleAccuracy = { settings: internAccuracy(), notices: [] };
  #destroyedBecause: string | null = null;
  /** Aborts when the engine or its device ends. */
  readonly #ended = new AbortController();
  readonly #onLoss: OnLoss = {
    react: (because) => {
      this.#stopWork(because);
      // A lost device has freed all buffers: end their accounting.
      this.#memory.destroyAll();
    },
  };

  /** @internal Use `SplatEngine.create`, which checks the options. */
  constructor(device: GPUDevice, ownsDevice: boolean, options: EngineOptions, seams: EngineSeams) {
    this.device = device;
    this.adapterLabel = adapterLabel(device.adapterInfo);
    this.hasGpuTimestamps = device.features.has('timestamp-query');
    this.#memory = new GpuMemory(device, options.memoryBudgetBytes, null, options.limitAdvice);
    this.#pipelines = new Pipelines(device, seams.mutation, this.#counting);
    this.#ownsDevice = ownsDevice;
    const limit = device.limits.maxComputeWorkgroupsPerDimension;
    this.#dispatchRow = Math.min(seams.maxWorkgroupsPerDimension ?? limit, limit);
    this.#tileBudgetBytes = options.tileBudgetBytes ?? DEFAULT_TILE_BUDGET_BYTES;
    this.#submissionBudgetMs = options.submissionBudgetMs ?? DEFAULT_SUBMISSION_BUDGET_MS;
    this.#ingestMinRows = seams.ingestMinRows ?? INGEST_MIN_ROWS;
    const { streamBudgetBytes: budgetBytes } = options;
    this.#streamShares = { budgetBytes, sharers: new Set(), turn: Promise.resolve() };
    this.#targets = new AccuracyTargets({
      measure: async (target, frame, options) => {
        // Most pages never use a target, so they do not load this module.
        const { measureTarget } = await fetched('measuring', import('./measure/measure-target.ts'));
        return measureTarget(this, target, frame, options);
      },
      adopt: (choice, clouds) => this.#adopt(choice, clouds),
    });
    this.#takeAccuracy(options.accuracy ?? DEFAULT_ACCURACY);
    this.lost = lossOf(device, this.#onLoss);
  }

  /**
   * Default settings of frames, and the settings that clouds are packed for when they are loaded.
   * Under a target these are the settings chosen for it last, or `balanced` before the first
   * choice; a view of other clouds may have its own choice.
   */
  get accuracy(): AccuracySettings {
    return this.#accuracy.settings;
  }

  /** One sentence for each setting of `accuracy` that the device does not support. */
  get notices(): readonly string[] {
    return this.#accuracy.notices;
  }

  /**
   * Changes `accuracy`. Views draw with it from their next frame on, at first from the planes that
   * their clouds hold. Each cloud then gets its precisions as by `requestPrecision`; if that fails,
   * the cloud stays unchanged. For a target, this happens once settings have been chosen: see
   * `SplatView.onAccuracyChosen`.
   *
   * @returns the clouds that could not be given the requested precision; resolves when all clouds
   *   are done and never rejects. A later change replaces this one.
   * @throws InvalidArgumentError for unknown settings; nothing changes then.
   */
  setAccuracy(
    accuracy: AccuracyRequest,
    options: SetAccuracyOptions = {},
  ): Promise<readonly PrecisionProblem[]> {
    this.#checkUsable();
    given(options);
    this.#takeAccuracy(accuracy);
    // The precision that a target needs is unknown until it has been measured.
    return this.#requestPrecisions(this.#target ? [] : [...this.#clouds], options);
  }

  /**
   * Returns the settings closest to `accuracy` (default: the engine's) that this device supports,
   * and a notice for each setting that it does not support. Equal settings are the same object.
   *
   * @throws InvalidArgumentError for unknown settings.
   */
  resolveAccuracy(accuracy?: Accuracy): PossibleAccuracy {
    if (accuracy === undefined) return this.#accuracy;
    const requested = internAccuracy(accuracy);
    const possible = this.#possible.get(requested) ?? possibleOn(this.device, requested);
    this.#possible.set(requested, possible);
    return possible;
  }

  /**
   * Reads splats, in a worker if workers are available, and uploads them. Addresses, Files and
   * Blobs are kept as handles, so that `requestPrecision` can read them again.
   *
   * @throws SplatFileError, SplatSourceError, GpuLimitError, InvalidArgumentError; the signal's
   *   reason if it aborts; DestroyedError if the engine or the device ends. Reading stops then, and
   *   nothing is kept.
   */
  async load(source: SplatSource, options: LoadOptions = {}): Promise<SplatCloud> {
    this.#checkUsable();
    checkLoadOptions(options);
    const signal = this.#untilEnded(options.signal);
    const { onDestroyed } = this.#optionsOf({});
    const from = knownSource(source, options);
    const streaming = loadStreamed(this.#streamContext, from, { ...options, signal }, { onDestroyed });
    const streamed = streaming && (await streaming);
    if (streamed) return this.#own(streamed);
    const { accuracy } = this;
    const { geometryPrecision, shPrecision } = options.precision ?? accuracy;
    const { name } = from;
    const { format, maxBytes, maxSplats, request, onPreview, fit = 'exact' } = options;
    const sourceOptions = { format, maxBytes, maxSplats, request };
    const made = { name, source: lastingOf(from), sourceOptions };
    const rowsTo = this.#rowsTo({ geometryPrecision, shPrecision, name, onPreview, fit, signal });
    const ingest = rowsTo.sink;
    let cloud: SplatCloud;
    try {
      this.#foreseeRows(from, ingest);
      const loaded = await loadOrPass(from, { ...options, signal, geometryPrecision, shPrecision }, rowsTo);
      if (loaded === 'passed') cloud = this.#addIngested(await ingest.finish(), made);
      else {
        ingest.destroy();
        cloud = await this.#addFitting(loaded, made, fit, signal);
      }
      if (signal.aborted) cloud.destroy();
      signal.throwIfAborted();
    } catch (error) {
      ingest.destroy();
      // The end of the engine also ended the wait.
      signal.throwIfAborted();
      throw error;
    }
    if (!options.precision && accuracy !== this.accuracy) void this.#requestPrecisions([cloud]);
    return cloud;
  }

  /** A signal that aborts when `signal` does, and when the engine or its device ends. */
  #untilEnded(signal: AbortSignal | undefined): AbortSignal {
    return AbortSignal.any([this.#ended.signal, signal ?? []].flat());
  }

  /** @internal Shows a scene in bricks, as `load` does. */
  async stream(scene: BrickScene, options: StreamOptions = {}): Promise<SplatCloud> {
    this.#checkUsable();
    const { streamBricks } = await fetched('streaming', import('./clouds/bricks/brick-parts.ts'));
    const signal = this.#untilEnded(options.signal);
    const { onDestroyed } = this.#optionsOf({});
    const cloud = await streamBricks(this.#streamContext, scene, { ...options, signal }, { onDestroyed });
    return this.#own(cloud);
  }

  /**
   * Packs and uploads splats that are already in memory, in any order; rows with non-finite values
   * are dropped and counted. The cloud keeps `set` by reference, for `requestPrecision`.
   *
   * @throws GpuLimitError if limits or budgets are exceeded. A lack of memory is reported later: see
   *   `SplatCloud.uploaded`.
   */
  add(set: SplatSet<Harmonics>, options: { readonly name?: string } = {}): SplatCloud {
    return this.addPacked(packSet(set, this.accuracy), { ...options, source: set });
  }

  /**
   * Uploads the result of `packCloud`, made on this thread or another and packed for any accuracy:
   * frames draw the cloud in the precision that it holds.
   *
   * @param options.source where `requestPrecision` can read the same splats again: their file, or
   *   `packed` itself if its memory stays in use anyway. If there are several, the first that is
   *   fine enough is used, so list cheap sources first. Kept by reference; by default nothing is
   *   kept.
   * @param options.sourceOptions how that file is read.
   * @throws GpuLimitError if limits or budgets are exceeded. A lack of memory is reported later: see
   *   `SplatCloud.uploaded`.
   */
  addPacked(packed: PackedCloud, options: NewCloudOptions = {}): SplatCloud {
    return this.#upload(packed, options);
  }

  /**
   * Makes a cloud of splats that your own GPU work writes into buffers of `engine.device`, such as a
   * simulation in a compute pass. Nothing passes through the CPU. The cloud takes 32 bytes per splat,
   * or 64 as `f32`, besides the buffers. Its code is fetched by the first call.
   *
   * @returns when the splats can be drawn, as the buffers hold them now.
   * @throws InvalidArgumentError naming an option that is wrong, or a buffer that is too small, lacks
   *   the usage STORAGE or is of another device; GpuLimitError if limits or budgets are exceeded, or
   *   memory is lacking; DestroyedError if a buffer is destroyed, or the engine or device ends;
   *   CodeUnavailableError.
   * @example
   * const usage = GPUBufferUsage.STORAGE;
   * const bufferOf = (values: number) => engine.device.createBuffer({ size: 4 * values * count, usage });
   * const [positions, scales, colors] = [bufferOf(3), bufferOf(3), bufferOf(3)];
   * const splats = await engine.addGpuSplats({
   *   count,
   *   positions: { buffer: positions },
   *   scales: { buffer: scales },
   *   colors: { buffer: colors },
   * });
   * requestAnimationFrame(function loop() {
   *   simulate(positions, scales, colors); // submits a compute pass
   *   splats.changed();
   *   view.render({ camera, clouds: [{ cloud: splats.cloud }], widthPx, heightPx });
   *   requestAnimationFrame(loop);
   * });
   */
  async addGpuSplats(options: GpuSplatsOptions): Promise<GpuSplats> {
    this.#checkUsable();
    const { GpuSplats } = await fetched(
      'splats in buffers',
      import('./features/gpu-splats/gpu-splats.clouds.ts'),
    );
    this.#checkUsable();
    const { name } = given(options, { name: 'a string?' });
    const context = { ...this.#dispatchContext, precision: this.accuracy, made: this.#optionsOf({ name }) };
    const splats = await GpuSplats.make(context, options);
    if (this.#destroyedBecause !== null) splats.cloud.destroy();
    this.#checkUsable();
    this.#clouds.add(splats.cloud);
    return splats;
  }

  #upload(packed: PackedCloud, options: LoadedCloudOptions): SplatCloud {
    this.#checkUsable();
    checkPacked(packed);
    const own = this.#optionsOf(given(options, { name: 'a string?' }));
    return this.#own(SplatCloud.upload(this.#memory, this.device.limits, packed, own));
  }

  /**
   * Makes the cloud's own lease claim this precision, which frees the planes that only that lease
   * claimed before: see `cloud.hold`. A later request for the cloud replaces this one.
   *
   * @throws the errors that the `met` of a lease rejects with.
   */
  async requestPrecision(
    cloud: SplatCloud,
    precision: CloudPrecision,
    options: HoldOptions = {},
  ): Promise<void> {
    this.#checkUsable();
    await given(cloud, CLOUD, 'cloud').ownLease.change(precision, options);
  }

  /** Creates a view that draws on `canvas`, or, without one, a view whose images are read back. */
  createView(options: { readonly canvas?: HTMLCanvasElement | OffscreenCanvas } = {}): SplatView {
    this.#checkUsable();
    const { canvas } = given(options);
    if (canvas !== undefined) given(canvas, { getContext: 'a function' }, 'canvas');
    const format = globalThis.navigator?.gpu?.getPreferredCanvasFormat() ?? 'rgba8unorm';
    const forget = (destroyed: SplatView) => this.#views.delete(destroyed);
    const view = new SplatView(this.#viewContext(), canvas ?? null, format, forget);
    this.#views.add(view);
    this.#foreseeFrames(view);
    return view;
  }

  /** Creates a view that draws inside the frames of another renderer on the same device. */
  createEmbeddedView(): EmbeddedView {
    this.#checkUsable();
    const view = new EmbeddedView(this.#viewContext(), (destroyed) => this.#views.delete(destroyed));
    this.#views.add(view);
    return view;
  }

  /** Effects of the view that was drawn last: see `SplatView.effects`. */
  effects(): readonly EffectEntry[] {
    return this.#lastDrawn()?.effects() ?? [];
  }

  /** How exactly the view that was drawn last is drawn, and why; null before the first frame. */
  drawnAccuracy(): DrawnAccuracy | null {
    const last = this.#lastDrawn();
    if (!last?.shape) return null;
    const { rasterizer, reason } = last.rasterizer;
    const { shape, accuracyChoice: choice } = last;
    return { settings: shape.accuracy, choice, rasterizer, rasterizerReason: reason };
  }

  #lastDrawn(): SplatView | EmbeddedView | undefined {
    return [...this.#views].toSorted((a, b) => b.drawnAs - a.drawnAs)[0];
  }

  /** The clouds that the engine holds, oldest first. */
  get clouds(): readonly SplatCloud[] {
    return [...this.#clouds];
  }

  /** GPU memory that the engine holds now; none once it was destroyed, or its device was lost. */
  memory(): EngineMemory {
    const hasEnded = this.#destroyedBecause !== null;
    const clouds = (hasEnded ? [] : [...this.#clouds]).map((cloud) => ({
      name: cloud.name,
      ...cloud.planes.memory(),
      ...(cloud.levels && { levelsBytes: cloud.levels.bytes, totalBytes: cloud.bytes }),
    }));
    const views = (hasEnded ? [] : [...this.#views]).map((view) => view.memory);
    return {
      ...this.#memory.report(),
      scene: { totalBytes: totalOf(clouds), clouds },
      frames: { totalBytes: totalOf(views), views },
    };
  }

  /** Counts of the engine's work so far. */
  counters(): EngineCounters {
    return { ...this.#counting };
  }

  /** Frees everything that the engine made, including the device unless `options.device` was given. */
  destroy(): void {
    if (this.#destroyedBecause === 'the engine was destroyed') return;
    this.#onLoss.react = null;
    this.#stopWork('the engine was destroyed');
    // An error at the end of one view or cloud must not keep the others alive.
    for (const view of [...this.#views]) callListener(() => view.destroy());
    for (const cloud of [...this.#clouds]) callListener(() => cloud.end('its engine was destroyed'));
    // A host submits the commands recorded by embedded views before it yields to microtasks.
    queueMicrotask(() => {
      this.#memory.destroyAll();
      if (this.#ownsDevice) this.device.destroy();
    });
  }

  #takeAccuracy(request: AccuracyRequest): void {
    const target = internTarget(request);
    const accuracy = target
      ? (this.#targets.latest(target)?.settings ?? DEFAULT_ACCURACY)
      : (request as Accuracy);
    this.#accuracy = this.resolveAccuracy(accuracy);
    if (this.#target && this.#target !== target) this.#targets.withdraw(this.#target);
    this.#target = target;
  }

  /** Adopts a choice for the engine's own target as its settings; frees undrawn planes. */
  async #adopt(choice: AccuracyChoice, clouds: readonly SplatCloud[]): Promise<void> {
    const { target, settings } = choice;
    if (target === this.#target) this.#accuracy = this.resolveAccuracy(settings);
    const others = [...this.#views].filter(({ accuracyChoice }) => accuracyChoice !== choice);
    const requests = clouds.map((cloud) => {
      const isShared = others.some(({ shape }) => shape !== null && requestsOther(shape, cloud, settings));
      const { ownLease } = cloud;
      const met = isShared ? ownLease.add(settings) : ownLease.change(settings);
      // A precision that cannot be made was not measured either; the table has a note.
      return met.catch(() => {});
    });
    await Promise.all(requests);
  }

  /** Requests the precisions of `accuracy`. Returns clouds that failed to get them. */
  async #requestPrecisions(
    clouds: readonly SplatCloud[],
    { signal, onProgress }: SetAccuracyOptions = {},
  ): Promise<PrecisionProblem[]> {
    const { accuracy } = this;
    const outcomes = clouds.map((cloud) =>
      this.requestPrecision(cloud, accuracy, {
        signal,
        onProgress: onProgress && ((progress) => onProgress(progress, cloud)),
      }).then(
        () => null,
        (error: Error) => ({ cloud, error }),
      ),
    );
    const problems = (await Promise.all(outcomes)).filter((problem) => problem !== null);
    const isCancelled = (error: Error) =>
      error.name === 'AbortError' ||
      error instanceof DestroyedError ||
      (signal?.aborted && error === signal.reason);
    return problems.filter(({ error }) => !isCancelled(error));
  }

  /** Compiles shaders that a first frame is likely to need, while the page looks for its file. */
  #foreseeFrames(view: SplatView): void {
    if (this.#compilesAhead) view.expectCloud(emptyCloud(this.#memory, LIKELY_SH_DEGREE, this.accuracy));
  }

  /** Compiles the shaders that the rows of `source` are likely to need, while it is opened. */
  #foreseeRows(source: KnownSource, ingest: LazyIngest): void {
    const { name, kind } = source;
    const heldBytes = kind === 'bytes' ? source.bytes.byteLength : Number.POSITIVE_INFINITY;
    const bytes = kind === 'blob' ? source.blob.size : heldBytes;
    if (this.#compilesAhead && bytes >= this.#ingestMinRows * LEAST_ROW_BYTES)
      ingest.foresee({
        shDegree: LIKELY_SH_DEGREE,
        hasPalette: /\.sog$/i.test(name),
        hasByteHarmonics: /\.(compressed\.ply|spz)$/i.test(name),
      });
  }

  /** False on a CPU: compiling shaders that prove unnecessary would delay the necessary ones. */
  get #compilesAhead(): boolean {
    return !isSoftwareAdapter(this.device.adapterInfo);
  }

  get #dispatchContext(): DispatchContext {
    return {
      device: this.device,
      pipelines: this.#pipelines,
      memory: this.#memory,
      dispatchRow: this.#dispatchRow,
    };
  }

  get #streamContext(): StreamContext {
    return { ...this.#dispatchContext, shares: this.#streamShares };
  }

  /** Takes the rows of one file to the GPU. */
  #rowsTo(options: RowIngestOptions) {
    return {
      sink: new LazyIngest(this.#dispatchContext, options),
      files: rowFilesFor(this.device.limits, this.#ingestMinRows),
    };
  }

  /** Uploads a cloud and waits for its memory. Under `auto`, makes it coarser if memory is lacking. */
  async #addFitting(
    packed: PackedCloud,
    made: NewCloudOptions,
    mode: FitMode,
    signal: AbortSignal,
  ): Promise<SplatCloud> {
    try {
      const cloud = this.addPacked(packed, made);
      await cloud.uploaded;
      return cloud;
    } catch (failure) {
      if (!(failure instanceof GpuLimitError) || !failure.limit.startsWith('memory')) throw failure;
      const { fitPacked } = await fetched('fitting', import('./clouds/fit-settings.ts'));
      const { name = 'splats' } = made;
      const fitted = await fitPacked(packed, { memory: this.#memory, name, failure, signal }, mode);
      const cloud = this.#upload(fitted.packed, { ...made, ...sourceOf(fitted.fit, made), fit: fitted.fit });
      await cloud.uploaded;
      return cloud;
    }
  }

  #addIngested({ planes, contents, preview, fit }: IngestedCloud, options: NewCloudOptions): SplatCloud {
    const own = this.#optionsOf({ ...options, ...sourceOf(fit, options), fit });
    const onDestroyed = (cloud: SplatCloud) => {
      preview?.destroy();
      own.onDestroyed?.(cloud);
    };
    return this.#own(new SplatCloud(this.device, planes, contents, { ...own, onDestroyed }));
  }

  #optionsOf({ name = 'splats', source, sourceOptions, fit }: LoadedCloudOptions): SplatCloudOptions {
    return {
      name,
      source,
      sourceOptions,
      fit,
      makePlanes: (...request) => this.#makePlanes(...request),
      makeLevels: (...request) => this.#makeLevels(...request),
      compileStretched: (cloud) => this.#compileFor(cloud, (shape) => ({ ...shape, isIsotropic: false })),
      onWritten: (bytes) => {
        this.#counting.uploadedBytes += bytes;
      },
      onDestroyed: (destroyed) => {
        this.#counting.cloudsDestroyed++;
        this.#clouds.delete(destroyed);
        this.#targets.stop(new DestroyedError(`The cloud ${name}`, 'it was destroyed'), destroyed);
      },
    };
  }

  #own(cloud: SplatCloud): SplatCloud {
    this.#clouds.add(cloud);
    this.#counting.uploads++;
    this.#counting.uploadedBytes += cloud.bytes;
    return cloud;
  }

  #viewContext(): ViewContext {
    return {
      device: this.device,
      pipelines: this.#pipelines,
      faults: this.#faults,
      memory: this.#memory.part(),
      counting: this.#counting,
      targetFor: (requested) => (requested === undefined ? this.#target : internTarget(requested)),
      accuracyFor: (requested) => this.resolveAccuracy(requested).settings,
      targets: this.#targets,
      dispatchRow: this.#dispatchRow,
      sortDevice: sortDeviceOf(this.device, fasterBallots(this.device)),
      tileBudgetBytes: this.#tileBudgetBytes,
      submissionBudgetMs: this.#submissionBudgetMs,
      cutFinders: {
        measureDetail: async (...request) =>
          (await import('./measure/choose-detail.ts')).chooseDetail(this, ...request),
        predictCuts: async (...request) =>
          (await import('./measure/choose-detail.ts')).predictCuts(this, ...request),
      },
      fasterRasterizer: rememberedRasterizer(this.adapterLabel),
      destroyedBecause: () => this.#destroyedBecause,
    };
  }

  #stopWork(because: string): void {
    this.#destroyedBecause = because;
    this.#ended.abort(new DestroyedError('This engine', because));
    for (const cloud of this.#clouds) {
      cloud.leases.end(new DestroyedError('This request', because));
      for (const feature of cloud.features) feature.end?.();
    }
    this.#targets.stop(new DestroyedError('This measurement', because));
  }

  async #makeLevels(cloud: SplatCloud, check: () => void): Promise<CloudLevels> {
    const { CloudLevels } = await fetched('levels of detail', import('./clouds/levels/cloud-levels.ts'));
    const context = { ...this.#dispatchContext, submissionBudgetMs: this.#submissionBudgetMs };
    return CloudLevels.make(context, cloud, () => {
      this.#checkUsable();
      check();
    });
  }

  async #makePlanes(...request: Parameters<PlaneMaker['make']>): Promise<void> {
    const [cloud, wanted, { signal }] = request;
    const { planes } = cloud;
    // Most claims are for planes that were uploaded, and need no plane maker.
    while (isHeld(planes.held, wanted)) {
      const { held } = planes;
      await this.#compilePlanes(cloud, planes.pagesFor(wanted));
      signal.throwIfAborted();
      this.#checkUsable();
      if (planes.held === held) return;
    }
    this.#planeMaker ??= this.#loadPlaneMaker().catch((error) => {
      // The chunk may be there at the next attempt.
      this.#planeMaker = null;
      throw error;
    });
    await (await this.#planeMaker).make(...request);
  }

  async #loadPlaneMaker(): Promise<PlaneMaker> {
    const { PlaneMaker } = await fetched('precisions', import('./clouds/plane-maker.ts'));
    return new PlaneMaker({
      ...this.#dispatchContext,
      counting: this.#counting,
      destroyedBecause: () => this.#destroyedBecause,
      compileFor: (cloud, precision) => this.#compilePlanes(cloud, precision),
      openRowPlanes: (options) => this.#rowsTo(options),
    });
  }

  async #compilePlanes(cloud: SplatCloud, precision: CloudPrecision): Promise<void> {
    await this.#compileFor(cloud, (shape) => ({ ...shape, planes: { ...shape.planes, ...precision } }));
  }

  /**
   * Compiles for every view that shows `cloud`; null: none does. If compiling fails, the frame that
   * needs the pipeline reports it.
   */
  #compileFor(cloud: SplatCloud, change: (shape: CloudShape) => CloudShape): Promise<void> | null {
    const stages = [...this.#views].flatMap(({ shape }) => {
      if (!shape?.clouds.some((each) => each.cloud === cloud)) return [];
      const clouds = shape.clouds.map((each) => (each.cloud === cloud ? change(each) : each));
      return frameStages({ ...shape, clouds });
    });
    // The frame that needs a stage reports its error.
    return stages.length > 0 ? this.#pipelines.prepare(stages).catch(() => {}) : null;
  }

  #checkUsable(): void {
    if (this.#destroyedBecause !== null) throw new DestroyedError('This engine', this.#destroyedBecause);
  }
}

/** Sizes of files whose rows are packed on the GPU, and of the pieces that are handed over. */
function rowFilesFor(limits: GPUSupportedLimits, minRows: number): RowFiles {
  const bytes = Math.min(limits.maxStorageBufferBindingSize, limits.maxBufferSize);
  // The longest lists on the GPU have a word per row.
  return { minRows, maxRows: Math.floor(bytes / 4), pieceBytes: Math.min(bytes / 2, PIECE_BYTES) };
}

/** A cloud with fewer degrees than its file cannot be read again. */
function sourceOf(fit: CloudFit | null, { source }: NewCloudOptions): Pick<NewCloudOptions, 'source'> {
  return { source: fit && fit.taken.shDegree < fit.wanted.shDegree ? null : source };
}

function totalOf(parts: readonly { readonly totalBytes: number }[]): number {
  return parts.reduce((sum, { totalBytes }) => sum + totalBytes, 0);
}

/** Whether a frame shows `cloud` in a precision that is not `precision`. */
function requestsOther(
  { clouds, accuracy }: FrameShape,
  cloud: SplatCloud,
  precision: CloudPrecision,
): boolean {
  const { geometryPrecision, shPrecision } = accuracy;
  const isSame = geometryPrecision === precision.geometryPrecision && shPrecision === precision.shPrecision;
  return clouds.some((each) => each.cloud === cloud) && !isSame;
}
