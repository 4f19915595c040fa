import type { AccuracySettings } from '../data/accuracy/accuracy.ts';
import { checkAccuracy } from '../data/accuracy/accuracy-target.ts';
import { DestroyedError } from '../data/errors.ts';
import { checkKind, given } from '../data/given.ts';
import { callListener } from '../data/listeners.ts';
import { effectsOf } from '../frame/cloud-plan.ts';
import { type FixedDetail, isFixedDetail, isSameDetail } from '../frame/detail.ts';
import { FrameParts } from '../frame/frame.ts';
import type { Destination } from '../frame/frame-part.ts';
import { drawnDetail, type FramePlan } from '../frame/frame-plan.ts';
import { FramePlanner, type PlannerContext } from '../frame/frame-planner.ts';
import { checkRequest, type FrameRequest } from '../frame/frame-request.ts';
import { type FrameOutput, type FrameShape, hasWideKeys } from '../frame/frame-shape.ts';
import { type EffectEntry, effectsLedger } from '../frame/ledger/ledger.ts';
import { cutErrorPx } from '../frame/level-cut.ts';
import type { Counting } from '../gpu/engine-counters.ts';
import type { GpuMemory, GpuMemoryReport } from '../gpu/gpu-memory.ts';
import type { FramePass } from '../gpu/passes.ts';
import type { Pipelines, StageDefinition } from '../gpu/pipelines.ts';
import type { FrameStatistics } from '../gpu/timing/frame-statistics.ts';
import type { AccuracyChoice } from '../measure/choose-accuracy.ts';
import type { RasterizeDepth } from '../stages/quads/quads.ts';
import type { ChooseAccuracyOptions } from './accuracy-targets.ts';
import type { PointCoverage, PointToCover } from './find-coverage.ts';
import { FrameWait, lackingLevels } from './frame-wait.ts';
import { MemoryRecovery } from './memory-recovery.ts';
import type { SplatPick } from './pick-splat.ts';
import type { MeasureDetail } from './psnr-promise.ts';
import {
  RasterizerChoice,
  type RasterizerChoiceOptions,
  type RasterizerReport,
} from './rasterizer-choice.ts';
import { type AccuracyContext, ViewAccuracy } from './view-accuracy.ts';
import type { DetailReport, ViewDetail } from './view-detail.ts';
import { ViewStreams } from './view-streams.ts';

/** The services of an engine that a view needs. */
export interface ViewContext extends AccuracyContext, PlannerContext {
  readonly device: GPUDevice;
  readonly pipelines: Pipelines;
  /** Counts the memory of this view, as part of the engine's. */
  readonly memory: GpuMemory;
  readonly counting: Counting;
  readonly tileBudgetBytes: number;
  readonly submissionBudgetMs: number;
  readonly measureDetail: MeasureDetail;
  /** The rasteriser that was faster on this adapter before, and a function to store it. */
  readonly fasterRasterizer: Pick<RasterizerChoiceOptions, 'remembered' | 'remember'>;
  /** Returns why nothing can be drawn any more; null if it can. */
  readonly destroyedBecause: () => string | null;
}

/** The requested depth test, then alternatives to draw with while its shaders compile. */
export type PossibleDepths = readonly [RasterizeDepth | null, ...(RasterizeDepth | null)[]];

/** The frame to draw for a request. */
export interface NextFrame {
  /**
   * The plan to draw: the requested one or, while its shaders compile, the same clouds with the
   * settings and effects of the last frame. Null if there is nothing to draw until then.
   */
  readonly plan: FramePlan | null;
  /** Whether the view already has the image of that frame, so that there is nothing to draw. */
  readonly isCurrent: boolean;
  /**
   * `ready`: `plan` is the requested frame. `waiting`: it follows, because shaders compile, clouds
   * are uploaded, or a preview is being replaced. `lacking`: it lacks memory, which is probed for
   * repeatedly.
   */
  readonly status: 'ready' | 'waiting' | 'lacking';
}

/** Bits by which depths differ in most scenes with the camera inside. */
const LIKELY_KEY_BITS = 27;

/** A resolved promise. */
export const DONE = Promise.resolve();

let picking: typeof import('./pick-splat.ts') | null = null;

/**
 * The common part of all views: plans the next frame for a request, and has statistics and picks of
 * the last one. Subclasses decide when a frame is drawn and where its image goes.
 */
export abstract class View {
  /** Called with the statistics of each measured frame, some frames later; null for no call. */
  onStatistics: ((statistics: FrameStatistics) => void) | null = null;
  /**
   * Called when settings have been chosen for a target (`accuracy: { minPsnrDb: 45 }`). Measuring
   * takes seconds. It begins half a second after the first frame, and after the last change of its
   * size. A scene is measured again when its clouds change, but not when the camera moves. A
   * `SplatView` has already drawn its last frame with the choice; an `EmbeddedView` has called
   * `onReady`, for its host to prepare the frame again. Null for no call.
   */
  onAccuracyChosen: ((choice: AccuracyChoice) => void) | null = null;
  protected readonly context: ViewContext;
  /** The buffers and textures of the view's frames. */
  protected parts: FrameParts;
  protected readonly recovery: MemoryRecovery;
  protected readonly wait: FrameWait;
  /**
   * Settles when the waiting newest request has been drawn; null if the last frame is the newest.
   */
  protected waiting: Promise<void> | null = null;
  /** Settles when the last frame is complete, and the device has confirmed memory for it. */
  protected settled = DONE;
  protected readonly streams = new ViewStreams();
  readonly #planner: FramePlanner;
  readonly #accuracy: ViewAccuracy;
  /** Finds detail; null until a request needs it and its code has been fetched. */
  #detail: ViewDetail | null = null;
  #detailLoading: Promise<void> | null = null;
  /** Chooses the faster rasteriser for the setting `auto`. */
  readonly #choice: RasterizerChoice;
  readonly #onDestroyed: () => void;
  /** The plan of the newest request; null if it has not been drawn. */
  #requested: FramePlan | null = null;
  #frameNumber = 0;
  #drawnAs = 0;
  #statistics: FrameStatistics | null = null;
  /** Error of the cuts in the last measured frame, px, and its detail. */
  #reached: { readonly detail: FixedDetail; readonly errorPx: number | null } = {
    detail: 'full',
    errorPx: null,
  };
  /** Settles when the last frame has been measured. */
  #measured = DONE;
  #isDestroyed = false;

  protected constructor(context: ViewContext, output: FrameOutput, onDestroyed: () => void) {
    this.context = context;
    this.#onDestroyed = onDestroyed;
    this.parts = new FrameParts(context);
    this.wait = new FrameWait(context.pipelines, (request) => this.#resume(request));
    this.#planner = new FramePlanner(context, output, (shape) => this.wait.isReadyOrCompiling(shape));
    this.#choice = new RasterizerChoice({
      hasTimestamps: context.device.features.has('timestamp-query'),
      ...context.fasterRasterizer,
    });
    this.recovery = new MemoryRecovery(context.memory, {
      parts: () => this.parts,
      startOver: () => this.startOver(),
      rejectTiles: (reason, load) => this.#choice.rejectTiles(reason, load),
      restore: (sound) => this.#restore(sound),
      drawSuccessor: (again) => this.#drawSuccessor(again),
    });
    this.#accuracy = new ViewAccuracy(context, (choice, request) => {
      this.drawAgain(request);
      // After `onReady`, which is called in an earlier microtask.
      queueMicrotask(() => {
        if (!this.#isDestroyed) callListener(this.onAccuracyChosen, choice);
      });
    });
  }

  /**
   * @internal Whether isotropic splats may use their own shaders; false to measure without them.
   */
  set mayBeIsotropic(mayBeIsotropic: boolean) {
    this.#planner.mayBeIsotropic = mayBeIsotropic;
  }

  /** The newest statistics, or null before the first. */
  get statistics(): FrameStatistics | null {
    return this.#statistics;
  }

  /** The last choice for the target; null before the first, and if settings were requested. */
  get accuracyChoice(): AccuracyChoice | null {
    return this.#accuracy.choice;
  }

  /** Detail of the last frame; null before the first. */
  get detail(): DetailReport | null {
    const plan = this.prepared;
    if (!plan) return null;
    const { detail: asked = 'full' } = plan.request;
    const found = this.#detail?.report(plan);
    return {
      asked,
      drawn: drawnDetail(plan),
      predictedPsnrDb: null,
      measuredPsnrDb: null,
      isComplete: isFixedDetail(asked) || this.#detailLoading === DONE,
      ...found,
      ...(this.streams.complete && { isComplete: false }),
      missing: this.streams.missing,
    };
  }

  /**
   * Resolves when the last frame has been drawn and its image is final unless something moves. If
   * detail has to be found, the image at rest is drawn again with it first.
   *
   * @throws errors of `whenDrawn`.
   */
  async whenComplete(): Promise<void> {
    do {
      await this.#detailLoading;
      await this.drawn;
      await this.streams.complete;
      await this.#detail?.complete;
      await this.drawn;
      // The measured error of a budget decides which parts of streamed scenes are needed.
      if (this.streams.areThere) await this.#measured;
    } while (this.streams.complete || this.#detail?.complete);
    if (this.recovery.error) throw this.recovery.error;
  }

  /**
   * Measures the last frame now, and chooses settings that meet its target again. Applies to all
   * views with the same target and clouds, at the size of the largest.
   *
   * @throws InvalidArgumentError if there is no frame yet, or it was drawn without a target;
   *   DestroyedError; an AbortError if the view is destroyed or a later call takes over; the
   *   signal's reason. On failure the settings stay.
   */
  async chooseAccuracy(options: ChooseAccuracyOptions = {}): Promise<AccuracyChoice> {
    this.checkUsable();
    return this.#accuracy.choose(given(options));
  }

  /**
   * Returns the splat that contributes most to a pixel of the last image. Objects of other
   * renderers in front of it are ignored. Null if there is no splat, outside the image, and before
   * the first frame.
   *
   * @param xPx, yPx from the top left of the image; a fractional position belongs to the pixel that
   *   contains it.
   * @throws DestroyedError if the view or its engine ends before the result is read.
   */
  async pick(xPx: number, yPx: number): Promise<SplatPick | null> {
    this.checkUsable();
    checkKind('xPx', xPx, 'a number');
    checkKind('yPx', yPx, 'a number');
    // Fetched on demand, because most pages never pick. Later picks search the current frame at
    // once.
    picking ??= await import('./pick-splat.ts');
    const { pickStage, pickInImage } = picking;
    return this.#search(pickStage, (plan) => pickInImage(this.context, this.parts, plan, xPx, yPx));
  }

  /**
   * Returns how far splats, and opaque objects of the host's renderer, cover points of the world in
   * the last frame. Takes at most 1,024 points, in one small read-back. Null before the first
   * frame.
   *
   * @throws InvalidArgumentError for too many points and for numbers that are not finite;
   *   GpuLimitError if the device lacks memory; DestroyedError if the view or its engine ends
   *   before the result is read.
   */
  async coverage(points: readonly PointToCover[]): Promise<PointCoverage[] | null> {
    this.checkUsable();
    const { checkPoints, coverStage, findCoverage } = await import('./find-coverage.ts');
    checkPoints(points);
    return this.#search(
      (plan) => coverStage(this.parts, plan),
      (plan, stage) => findCoverage(this.context, this.parts, plan, stage, points),
    );
  }

  /** Runs `find` over the last frame, once its stage is compiled; null without a frame. */
  async #search<Found>(
    stageOf: (plan: FramePlan) => StageDefinition,
    find: (plan: FramePlan, stage: StageDefinition) => Promise<Found>,
  ): Promise<Found | null> {
    const { pipelines } = this.context;
    for (;;) {
      // While the stage compiles, a frame with other record formats may be drawn, or the view
      // destroyed.
      this.checkUsable();
      if (!this.prepared) return null;
      const stage = stageOf(this.prepared);
      if (pipelines.areReady([stage])) return find(this.prepared, stage);
      await pipelines.prepare([stage]);
    }
  }

  /**
   * Lists all effects of the last frame, on and off, with the reason; empty before the first frame.
   * While shaders for other effects compile, the last frame has the old effects.
   */
  effects(): readonly EffectEntry[] {
    const plan = this.prepared;
    if (!plan) return [];
    const { memory } = this.context;
    const { shared, inputs, resolveDepth, compose, tileLists } = this.parts;
    const bytesOf = (each: readonly (GPUBuffer | GPUTexture | null | undefined)[]) =>
      [...new Set(each)].reduce((sum, resource) => sum + memory.bytesOf(resource), 0);
    const held = {
      levelBytes: (cloudIndex: number) => inputs.levelBytes(cloudIndex),
      selectionBytes: (cloudIndex: number) => inputs.selectionBytes(cloudIndex),
      testedDepthBytes: bytesOf([shared.hostDepth]) + resolveDepth.bytes,
      writtenDepthBytes: bytesOf([
        shared.image?.depthLayer,
        shared.blended?.depthLayer,
        compose.image?.depth,
      ]),
      tilesBytes: tileLists.bytes,
    };
    return effectsLedger({ plan, held, rasterizer: this.rasterizer });
  }

  /** The rasteriser of this view, and the known times of both. */
  get rasterizer(): RasterizerReport {
    return this.#choice.reportOf(this.shape);
  }

  /**
   * @internal Sequence number of the last frame among all frames of the engine; 0 before the first.
   */
  get drawnAs(): number {
    return this.#drawnAs;
  }

  /** @internal GPU memory of the view. */
  get memory(): GpuMemoryReport {
    return this.context.memory.report();
  }

  /** Shape of the last frame: its clouds, their effects and its passes; null before the first. */
  get shape(): FrameShape | null {
    return this.parts.shape;
  }

  /** Plan of the last frame; null before the first. */
  protected get prepared(): FramePlan | null {
    return this.#planner.last;
  }

  protected get isDestroyed(): boolean {
    return this.#isDestroyed;
  }

  /** See `SplatView.whenDrawn`. */
  protected get drawn(): Promise<void> {
    return this.waiting ?? this.settled;
  }

  protected canStillDraw({ clouds }: FrameRequest): boolean {
    const isUsable = !this.#isDestroyed && this.context.destroyedBecause() === null;
    return isUsable && clouds.every(({ cloud }) => !cloud.isDestroyed);
  }

  /** Draws a frame again whose memory was freed. Settles when it is complete. */
  protected abstract redraw(plan: FramePlan): Promise<void>;

  /** Draws the last request again, because settings, detail or streamed parts have changed. */
  protected abstract drawAgain(request: FrameRequest): void;

  /**
   * Called when a request need not wait any more.
   *
   * @param request the newest request: draw it, or let it wait again. Null if another was drawn
   *   meanwhile.
   * @returns a promise that settles when the request has been drawn; null if no frame follows.
   */
  protected abstract retry(request: FrameRequest | null): Promise<void> | null;

  /**
   * Checks a request.
   *
   * @returns whether it has pixels.
   * @throws InvalidArgumentError naming the argument and the reason; DestroyedError for a destroyed
   *   cloud; GpuLimitError for a cloud that lacked memory.
   */
  protected check(request: FrameRequest): boolean {
    checkRequest(request, this.context.device);
    if (request.widthPx > 0 && request.heightPx > 0) return true;
    // Planning checks these arguments, but a frame without pixels is not planned.
    for (const instance of request.clouds) effectsOf(instance);
    const { accuracy } = request;
    if (accuracy) checkAccuracy(accuracy);
    return false;
  }

  /** @throws GpuLimitError, once, if the last frame lacked memory. */
  protected throwLack(): void {
    const { error } = this.recovery;
    this.recovery.error = null;
    if (!error) return;
    this.settled = DONE;
    throw error;
  }

  /**
   * Plans a frame. If it cannot be drawn yet, its request waits.
   *
   * @param depths the requested depth test, then alternatives while its shaders compile.
   */
  protected next(request: FrameRequest, depths: PossibleDepths): NextFrame {
    for (const { cloud } of request.clouds) cloud.editing?.flush();
    const last = this.prepared;
    const isCurrent = last !== null;
    const held = request.clouds.flatMap(({ cloud }) => cloud.heldUntil ?? []);
    if (held.length > 0) {
      // If there is an image, callers get it until the planes have changed.
      if (!isCurrent) this.waiting = this.wait.begin(request, 'held', () => Promise.all(held));
      return { plan: last, isCurrent, status: 'waiting' };
    }
    const settings = this.#accuracy.settingsFor(request);
    const planWith = (detail?: FixedDetail) => this.#plan(request, settings, depths[0], detail);
    if (!isFixedDetail(request.detail ?? 'full')) this.#detailLoading ??= this.#loadDetail();
    const plan = this.#detail ? this.#detail.plan(request, last, planWith) : planWith();
    if (!plan.stands) {
      this.#requested = null;
      this.#setSights(plan);
    }
    if (!plan.stands && this.recovery.lacksRoomFor(plan)) {
      // Does not wait for the memory alone, so that a smaller request can replace it.
      const until = () => Promise.all([this.recovery.findRoom(), this.wait.whenReady(plan)]);
      if (this.recovery.isProbeDue) this.waiting = this.wait.begin(request, 'memory', until);
      return { plan: last, isCurrent, status: 'lacking' };
    }
    const isReady = plan.stands || (this.wait.isReady(plan.shape) && areUploaded(request));
    if (isReady && lackingLevels(plan).length === 0) {
      this.wait.end();
      this.waiting = null;
      // From here on the requested frame is the last one.
      this.recovery.error = null;
      if (plan.stands) this.#planner.keep(plan);
      else this.#requested = plan;
      return { plan, isCurrent: plan.stands, status: 'ready' };
    }
    this.waiting = this.wait.begin(request, 'shaders', () => this.wait.whenReady(plan));
    const stopgap = this.#planner.planStopgap(plan, depths);
    if (!stopgap || !this.wait.isReady(stopgap.shape))
      return { plan: null, isCurrent: false, status: 'waiting' };
    return { plan: stopgap, isCurrent: stopgap === last || stopgap.stands, status: 'waiting' };
  }

  /** Sets the sights of streams for a frame. */
  #setSights(plan: FramePlan): void {
    const { detail, errorPx } = this.#reached;
    const reachedPx = isSameDetail(detail, plan.detail) ? errorPx : null;
    this.streams.setSights(plan, reachedPx, () => this.#drawChanged(plan.request));
  }

  /** Draws the last request again, because parts of its scenes have changed on the GPU. */
  async #drawChanged(request: FrameRequest): Promise<void> {
    if (!this.canStillDraw(request)) return;
    this.drawAgain(request);
    await this.context.device.queue.onSubmittedWorkDone();
  }

  #plan(
    request: FrameRequest,
    accuracy: AccuracySettings,
    depth: RasterizeDepth | null,
    detail?: FixedDetail,
  ): FramePlan {
    const faster = this.#choice.rasterizerFor(depth);
    return this.#planner.plan(request, { accuracy, depth, faster, detail });
  }

  /** Fetched on demand, because most views never find detail. Images are full until then. */
  async #loadDetail(): Promise<void> {
    try {
      const { ViewDetail } = await import('./view-detail.ts');
      const { targetFor, measureDetail } = this.context;
      this.#detail = new ViewDetail({
        targetFor,
        measure: (minPsnrDb, request, options) =>
          measureDetail(minPsnrDb, { ...request, accuracy: this.shape?.accuracy }, options),
        redraw: (request) => this.drawAgain(request),
        precompile: (request, detail) => this.#precompileDetail(request, detail),
      });
      if (this.#isDestroyed) this.#detail.end();
      else if (this.prepared) this.drawAgain(this.prepared.request);
    } catch (error) {
      this.#detailLoading = DONE;
      console.warn(`The pictures of a view stay full: ${(error as Error).message}`);
    }
  }

  #precompileDetail(request: FrameRequest, detail: FixedDetail): void {
    if (!this.shape || !this.canStillDraw(request)) return;
    const { accuracy, depth, rasterizer } = this.shape;
    const plan = this.#planner.plan(request, { accuracy, depth, faster: rasterizer, detail });
    // The frame itself reports errors.
    this.wait.whenReady(plan).catch(() => {});
  }

  /**
   * Compiles the shaders of frames like `request`, for small and large ranges of depth. Draws
   * nothing.
   */
  protected precompile(request: FrameRequest): void {
    const { shape } = this.#plan(request, this.context.accuracyFor(undefined), null);
    const keyBits = Math.min(LIKELY_KEY_BITS, shape.accuracy.sortKeyBits);
    // Wide keys of any number of bits use the same shaders.
    const others = hasWideKeys(shape) ? [] : [{ ...shape, keyBits }];
    for (const likely of [shape, ...others]) this.wait.isReadyOrCompiling(likely);
  }

  /** Draws a frame by `work`: see `MemoryRecovery.draw`. @returns `settled`. */
  protected submit(plan: FramePlan, work: () => void): Promise<void> {
    this.settled = this.recovery.draw(plan, work) ?? DONE;
    return this.settled;
  }

  /**
   * Allocates a frame's buffers and writes its uniforms. Call within `submit`, before recording.
   * @throws GpuLimitError
   */
  protected makeRoom(plan: FramePlan): void {
    this.parts.fit(plan);
    this.#planner.take(plan, performance.now());
  }

  /** Frees the memory of the last frame and clears it. */
  protected startOver(): void {
    this.parts.destroy();
    this.parts = new FrameParts(this.context);
    this.recovery.forget();
    this.#planner.forget();
  }

  /** Draws a sound frame again. */
  async #restore({ request, shape, detail }: FramePlan): Promise<void> {
    // Another frame may have been drawn since.
    if (this.prepared || !this.canStillDraw(request)) return;
    const { accuracy, depth, rasterizer } = shape;
    try {
      const again = this.#planner.plan(request, { accuracy, depth, faster: rasterizer, detail });
      if (this.wait.isReady(again.shape)) await this.redraw(again);
    } catch {
      // Memory is lacking for the sound frame too; the view holds nothing.
    }
  }

  #drawSuccessor(again: FramePlan | null): Promise<void> | null {
    // `retry` may return `settled`, which is the very promise that awaits this call.
    if (!this.prepared) this.settled = DONE;
    // A caller may have requested another frame meanwhile.
    return this.retry(again && this.#requested === again ? again.request : null);
  }

  #resume(request: FrameRequest | null): Promise<void> | null {
    if (request) this.checkUsable();
    return this.#isDestroyed ? null : this.retry(request);
  }

  /** Passes that find and sort the visible splats of a frame that is about to be submitted. */
  protected orderPasses(): readonly FramePass[] {
    this.context.counting.framesPrepared++;
    return this.parts.orderPasses;
  }

  /** Passes that draw the visible splats. @throws GpuLimitError */
  protected drawPasses(destination: Destination): readonly FramePass[] {
    return this.parts.drawPasses(destination, this.#choice.sampleFor(this.prepared!, this.#statistics));
  }

  /** Records the end of a drawn frame. */
  protected recordEnd(encoder: GPUCommandEncoder): void {
    this.#drawnAs = ++this.context.counting.framesDrawn;
    this.parts.recordCounts(encoder);
  }

  /** Call when the frame of `request` has been drawn, or its image is already current. */
  protected onDrawn(request: FrameRequest): void {
    this.#accuracy.onDrawn(request);
    this.#detail?.onDrawn(request);
    this.streams.onFrame();
  }

  /** Reads the frame's statistics; call after submitting. Null if it was not measured. */
  protected measure(submittedMs = performance.now()): Promise<FrameStatistics | null> {
    const measured = this.#measure(submittedMs);
    const settle = () => {};
    this.#measured = measured.then(settle, settle);
    return measured;
  }

  async #measure(submittedMs: number): Promise<FrameStatistics | null> {
    const drawn = this.prepared;
    const { clouds = [] } = this.shape ?? {};
    const loadedSplats = clouds.reduce(
      (sum, { cloud, instanceCount }) => sum + cloud.count * (instanceCount ?? 1),
      0,
    );
    const errorPx = drawn && cutErrorPx(drawn.detail, drawn.clouds);
    const read = () =>
      this.parts.timer.read({ frame: ++this.#frameNumber, loadedSplats, cutErrorPx: errorPx }, submittedMs);
    const { memory } = this.context;
    // Buffers to read may turn out not to exist.
    const statistics = await memory.guard('A frame', '', read, this.recovery.isChecking).result;
    if (!statistics || this.#isDestroyed || !this.prepared) return null;
    const { tilePairs, visibleSplats } = statistics;
    const { tileLists } = this.parts;
    if (tilePairs !== null) tileLists.expect(tilePairs, visibleSplats, performance.now());
    this.#choice.addStatistics(
      this.prepared,
      statistics,
      tilePairs === null ? null : tileLists.whyTooMany(visibleSplats),
    );
    if (drawn) this.#detail?.addFrame(drawn, statistics.timing);
    this.#statistics = statistics;
    this.#reached = { detail: drawn?.detail ?? 'full', errorPx: statistics.cutErrorPx };
    // The last planned frame may lack this error, on which its sights depend.
    if (isSameDetail(this.#reached.detail, this.prepared.detail))
      this.streams.updateSights(this.prepared, this.#reached.errorPx);
    callListener(this.onStatistics, statistics);
    return statistics;
  }

  /**
   * Ends the view; returns false if it had already ended. Destroy `parts` when nothing uses them.
   */
  protected end(): boolean {
    if (this.#isDestroyed) return false;
    this.#isDestroyed = true;
    this.#accuracy.leave();
    this.#detail?.end();
    this.streams.leave();
    this.#onDestroyed();
    return true;
  }

  /** @throws DestroyedError */
  protected checkUsable(): void {
    const reason = this.#isDestroyed ? 'it was destroyed' : this.context.destroyedBecause();
    if (reason !== null) throw new DestroyedError('This view', reason);
  }
}

/** Whether all clouds of `request` are confirmed to be on the GPU. */
function areUploaded({ clouds }: FrameRequest): boolean {
  return clouds.every(({ cloud }) => cloud.isUploaded);
}
