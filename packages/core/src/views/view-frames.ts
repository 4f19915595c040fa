import { flushFeatures } from '../clouds/cloud-feature.ts';
import type { SplatCloud } from '../clouds/splat-cloud.ts';
import { type AccuracySettings, internAccuracy, LEAST_RESOLUTION_SCALE } from '../data/accuracy/accuracy.ts';
import { checkAccuracy } from '../data/accuracy/accuracy-target.ts';
import { DestroyedError, InvalidArgumentError, ShaderError } from '../data/errors.ts';
import { callListener } from '../data/listeners.ts';
import { FrameParts } from '../frame/frame.ts';
import type { Destination } from '../frame/parts/frame-part.ts';
import { type FixedDetail, isFixedDetail, isSameDetail } from '../frame/plan/detail.ts';
import { drawnDetail, type FramePlan } from '../frame/plan/frame-plan.ts';
import { FramePlanner, type PlannerContext } from '../frame/plan/frame-planner.ts';
import { checkRequest, type FrameRequest } from '../frame/plan/frame-request.ts';
import { type FrameOutput, hasWideKeys } from '../frame/plan/frame-shape.ts';
import { cutErrorPx } from '../frame/plan/level-cut.ts';
import { checkEffects } from '../gpu/effects/cloud-effects.ts';
import type { SplatEffect } from '../gpu/effects/effect.ts';
import type { EffectSet } from '../gpu/effects/effect-set.ts';
import type { Counting } from '../gpu/engine-counters.ts';
import type { GpuMemory } from '../gpu/gpu-memory.ts';
import type { FramePass } from '../gpu/passes.ts';
import type { Pipelines } from '../gpu/pipelines.ts';
import type { FrameStatistics } from '../gpu/timing/frame-statistics.ts';
import type { AccuracyChoice } from '../measure/choose-accuracy.ts';
import type { RasterizeDepth } from '../stages/quads/quads.ts';
import { DrawnStreams } from './drawn-streams.ts';
import type { MovingFrame } from './frame-pace.ts';
import { FrameWait, lackingLevels, type WaitReason } from './frame-wait.ts';
import { MemoryRecovery } from './memory-recovery.ts';
import type { CutFinders } from './psnr-promise.ts';
import { RasterizerChoice, type RasterizerChoiceOptions } from './rasterizer-choice.ts';
import { type AccuracyContext, ViewAccuracy } from './view-accuracy.ts';
import type { DetailReport, ViewDetail } from './view-detail.ts';

/** The services of an engine that a view needs. */
export interface ViewContext extends AccuracyContext, Required<PlannerContext> {
  readonly device: GPUDevice;
  readonly pipelines: Pipelines;
  /** Counts the memory of this view, as part of the engine's. */
  readonly memory: GpuMemory;
  readonly counting: Counting;
  readonly tileBudgetBytes: number;
  readonly submissionBudgetMs: number;
  readonly cutFinders: CutFinders;
  /** The rasteriser that was faster on this adapter before, and a function to store it. */
  readonly fasterRasterizer: Pick<RasterizerChoiceOptions, 'remembered' | 'remember'>;
  /** Returns why nothing can be drawn any more; null if it can. */
  readonly destroyedBecause: () => string | null;
}

/** How a kind of view draws. README.md defines "drawn", "waiting" and "complete". */
export interface ViewDrawing {
  /** Submits the work of a frame. Settles when the frame is drawn. */
  draw(plan: FramePlan): Promise<void>;
  /** Draws the last request again, because settings, detail or streamed parts have changed. */
  drawAgain(request: FrameRequest): void;
  /**
   * Called when a request stops waiting.
   *
   * @param request the newest request: draw it, or let it wait again. Null if another was drawn
   *   meanwhile.
   * @returns a promise that settles when the request is drawn; null if no frame follows.
   */
  drawWaiting(request: FrameRequest | null): Promise<void> | null;
  /** Called when there is a new `ViewFrames.fault`. */
  onFault(): void;
}

/** An error of the last frames that the view's owner has not received. */
export interface FrameFault {
  readonly error: Error;
  /** Clouds that are drawn otherwise, or not at all, because of it. */
  readonly clouds: readonly SplatCloud[];
}

/** Functions of a view's owner; null for no call. */
export interface ViewListeners {
  readonly onStatistics: ((statistics: FrameStatistics) => void) | null;
  readonly onAccuracyChosen: ((choice: AccuracyChoice) => void) | null;
}

/** The requested depth test, then alternatives to draw with while its shaders compile. */
export type PossibleDepths = readonly [RasterizeDepth | null, ...(RasterizeDepth | null)[]];

/** What a view shows for a request. */
export interface NextFrame {
  /**
   * The requested frame or, while it waits, the last frame, or the same clouds with the settings and
   * effects of the last frame. Null if there is nothing to show until then.
   */
  readonly plan: FramePlan | null;
  /** Whether `plan` is drawn already; else it is to be drawn now. */
  readonly isDrawn: boolean;
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
export const RESOLVED = Promise.resolve();

/** The frames of one view: plans the next one for a request, submits it, and measures it. */
export class ViewFrames {
  /** Set by the view that these are the frames of. */
  listeners!: ViewListeners;
  readonly context: ViewContext;
  /** The buffers and textures of the frames; replaced when the view starts over. */
  parts: FrameParts;
  readonly recovery: MemoryRecovery;
  readonly wait: FrameWait;
  readonly streams = new DrawnStreams();
  readonly accuracy: ViewAccuracy;
  readonly planner: FramePlanner;
  /** Chooses the faster rasteriser for the setting `auto`. */
  readonly choice: RasterizerChoice;
  /** The newest statistics; null before the first. */
  statistics: FrameStatistics | null = null;
  /** Sequence number of the last frame among all frames of the engine; 0 before the first. */
  drawnAs = 0;
  /** Settles when the newest request is drawn, which waits; null if none waits. */
  waiting: Promise<void> | null = null;
  /** Settles when the last submitted frame is drawn. */
  lastDrawn = RESOLVED;
  /** Null once it is received. */
  fault: FrameFault | null = null;
  /** Errors of left out effects that were faults. */
  readonly #told = new WeakSet<Error>();
  /** Message of the last fault of another kind: each attempt to make a shader has an error of its own. */
  #lastMessage = '';
  readonly #drawing: ViewDrawing;
  readonly #onDestroyed: () => void;
  /** Finds detail; null until a request needs it and its code has been fetched. */
  #detail: ViewDetail | null = null;
  #detailLoading: Promise<void> | null = null;
  /** Whether the code that finds detail could not be fetched. */
  #lacksDetail = false;
  /** The plan of the newest request, once it is submitted; null before. */
  #newest: FramePlan | null = null;
  #frameNumber = 0;
  /** Error of the cuts in the last measured frame, px, and its detail. */
  #reached: { readonly detail: FixedDetail; readonly errorPx: number | null } = {
    detail: 'full',
    errorPx: null,
  };
  /** Settles when the last frame has been measured. */
  #measured: Promise<unknown> = RESOLVED;
  #isDestroyed = false;

  constructor(context: ViewContext, output: FrameOutput, drawing: ViewDrawing, onDestroyed: () => void) {
    this.context = context;
    this.#drawing = drawing;
    this.#onDestroyed = onDestroyed;
    this.parts = new FrameParts(context);
    this.wait = new FrameWait(
      context.pipelines,
      (request) => this.#resume(request),
      (error, plan) => this.#canDrawWithout(error as Error, plan),
    );
    this.planner = new FramePlanner(context, output, (shape) => this.wait.isReadyOrCompiling(shape));
    this.choice = new RasterizerChoice({
      hasTimestamps: context.device.features.has('timestamp-query'),
      ...context.fasterRasterizer,
    });
    this.recovery = new MemoryRecovery(context.memory, {
      parts: () => this.parts,
      startOver: () => this.startOver(),
      rejectTiles: (reason, load) => this.choice.rejectTiles(reason, load),
      restore: (sound) => this.#restore(sound),
      drawSuccessor: (again) => this.#drawSuccessor(again),
    });
    this.accuracy = new ViewAccuracy(context, (choice, request) => {
      drawing.drawAgain(request);
      // After `onReady`, which is called in an earlier microtask.
      queueMicrotask(() => {
        if (!this.#isDestroyed) callListener(this.listeners.onAccuracyChosen, choice);
      });
    });
  }

  /** Plan of the last frame; null before the first. */
  get last(): FramePlan | null {
    return this.planner.last;
  }

  get isDestroyed(): boolean {
    return this.#isDestroyed;
  }

  /** Settles when the newest request is drawn. */
  get drawn(): Promise<void> {
    return this.waiting ?? this.lastDrawn;
  }

  /** Detail of the last frame; null before the first. */
  get detail(): DetailReport | null {
    const plan = this.last;
    if (!plan) return null;
    const { detail: asked = 'full' } = plan.request;
    const found = this.#detail?.report(plan);
    return {
      asked,
      drawn: drawnDetail(plan),
      movingScale: plan.movingScale,
      predictedPsnrDb: null,
      measuredPsnrDb: null,
      isComplete: isFixedDetail(asked) || this.#lacksDetail,
      ...found,
      ...(this.streams.complete && { isComplete: false }),
      missing: this.streams.missing,
    };
  }

  /** See `View.whenComplete`. */
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
    this.throwKept();
  }

  canStillDraw({ clouds }: FrameRequest): boolean {
    const isUsable = !this.#isDestroyed && this.context.destroyedBecause() === null;
    return isUsable && clouds.every(({ cloud }) => !cloud.isDestroyed);
  }

  /** @throws DestroyedError */
  checkUsable(): void {
    const reason = this.#isDestroyed ? 'it was destroyed' : this.context.destroyedBecause();
    if (reason !== null) throw new DestroyedError('This view', reason);
  }

  /**
   * Checks a request.
   *
   * @returns whether it has pixels.
   * @throws InvalidArgumentError naming the argument and the reason; DestroyedError for a destroyed
   *   cloud; GpuLimitError for a cloud that lacked memory.
   */
  check(request: FrameRequest): boolean {
    checkRequest(request, this.context.device);
    if (request.widthPx > 0 && request.heightPx > 0) return true;
    // Planning checks these arguments, but a frame without pixels is not planned.
    for (const instance of request.clouds) checkEffects(instance);
    const { accuracy } = request;
    if (accuracy) checkAccuracy(accuracy);
    return false;
  }

  /** @throws GpuLimitError if the last frame lacked memory; the error of the fault. */
  throwKept(): void {
    const error = this.recovery.error ?? this.fault?.error;
    if (error) throw error;
  }

  /** Throws the same errors, once. */
  throwReceived(): void {
    const error = this.recovery.error ?? this.fault?.error;
    if (!error) return;
    if (error === this.recovery.error) {
      this.recovery.error = null;
      this.lastDrawn = RESOLVED;
    } else this.fault = null;
    throw error;
  }

  /**
   * Plans a frame. If it cannot be drawn yet, its request waits.
   *
   * @param depths the requested depth test, then alternatives while its shaders compile.
   */
  next(request: FrameRequest, depths: PossibleDepths): NextFrame {
    for (const { cloud } of request.clouds) flushFeatures(cloud);
    const { last } = this;
    const isDrawn = last !== null;
    const held = request.clouds.flatMap(({ cloud }) => cloud.heldUntil ?? []);
    if (held.length > 0) {
      // If there is an image, callers get it until the planes have changed.
      if (!isDrawn) this.waitFor(request, 'held', () => Promise.all(held));
      return { plan: last, isDrawn, status: 'waiting' };
    }
    const settings = this.accuracy.settingsFor(request);
    const planWith = (moving?: MovingFrame) => this.#plan(request, settings, depths[0], moving);
    if (!isFixedDetail(request.detail ?? 'full')) this.#detailLoading ??= this.#loadDetail();
    const plan = this.#detail ? this.#detail.plan(request, last, planWith) : planWith();
    this.#tellOfLeftOut(plan);
    if (!plan.isDrawn) {
      this.#newest = null;
      this.#setSights(plan);
    }
    if (!plan.isDrawn && this.recovery.lacksRoomFor(plan)) {
      // Does not wait for the memory alone, so that a smaller request can replace it.
      const until = () => Promise.all([this.recovery.findRoom(), this.wait.whenReady(plan)]);
      if (this.recovery.isProbeDue) this.waitFor(request, 'memory', until);
      return { plan: last, isDrawn, status: 'lacking' };
    }
    const isReady = plan.isDrawn || (this.wait.isReady(plan.shape) && areUploaded(request));
    if (isReady && lackingLevels(plan).length === 0) {
      this.wait.end();
      this.waiting = null;
      // From here on the requested frame is the last one.
      this.recovery.error = null;
      if (plan.isDrawn) this.planner.keep(plan);
      else this.#newest = plan;
      return { plan, isDrawn: plan.isDrawn, status: 'ready' };
    }
    this.waitFor(request, 'shaders', () => this.wait.whenReady(plan));
    const stopgap = this.planner.planStopgap(plan, depths);
    if (!stopgap || !this.wait.isReady(stopgap.shape))
      return { plan: null, isDrawn: false, status: 'waiting' };
    return { plan: stopgap, isDrawn: stopgap === last || stopgap.isDrawn, status: 'waiting' };
  }

  /** Lets the newest request wait: see `FrameWait.begin`. */
  waitFor(request: FrameRequest, reason: WaitReason, until: () => Promise<unknown>): void {
    this.waiting = this.wait.begin(request, reason, until);
  }

  /**
   * Draws a frame by `work`, which may allocate, and records and submits commands: see
   * `MemoryRecovery.draw`. Makes room before, unless it is the last frame.
   *
   * @returns `lastDrawn`.
   */
  submit(plan: FramePlan, work: () => void): Promise<void> {
    const { device } = this.context;
    let refused: Promise<GPUError | null> | null = null;
    const fitted = () => {
      if (plan !== this.last) {
        this.parts.fit(plan);
        this.planner.take(plan, performance.now());
      }
      // Callers may destroy what their effects read; the device tells only of the submitted work.
      const readsResources = plan.clouds.some(({ uses }) =>
        uses.some(({ resources }) => resources.length > 0),
      );
      if (readsResources) device.pushErrorScope('validation');
      try {
        work();
      } finally {
        if (readsResources) refused = device.popErrorScope();
      }
    };
    const checked = this.recovery.draw(plan, fitted) ?? RESOLVED;
    this.lastDrawn = refused ? this.#afterRefusal(plan, checked, refused) : checked;
    // Only callers that await the frame get the error.
    this.lastDrawn.catch(() => {});
    return this.lastDrawn;
  }

  /** Asks the device which resources of effects it refuses. Resolves with whether it refuses any. */
  async findRefused({ clouds }: FramePlan): Promise<boolean> {
    const { device } = this.context;
    const reading = clouds.flatMap(({ uses }) => uses.filter(({ resources }) => resources.length > 0));
    await Promise.all(reading.map(({ use, resources }) => use.effect.resources!.ask(use, resources, device)));
    return reading.some(({ use, resources }) => use.effect.resources!.refusal(resources, device) !== null);
  }

  /** If the device has refused a frame, draws it again without the effects whose resources it refuses. */
  async #afterRefusal(
    plan: FramePlan,
    checked: Promise<void>,
    refused: Promise<GPUError | null>,
  ): Promise<void> {
    await checked;
    // A lost device does not answer, and its loss ends all work anyway.
    const error = await refused.catch(() => null);
    if (!error) return;
    this.planner.refuse(plan);
    if (!this.canStillDraw(plan.request)) return;
    if (!(await this.findRefused(plan))) {
      this.#canDrawWithout(frameError(error), plan);
      return;
    }
    if (this.canStillDraw(plan.request)) this.#drawing.drawAgain(this.last?.request ?? plan.request);
  }

  /** Submits the commands that `record` records. */
  run(label: string, record: (encoder: GPUCommandEncoder) => void): void {
    const { device } = this.context;
    const encoder = device.createCommandEncoder({ label });
    record(encoder);
    device.queue.submit([encoder.finish()]);
  }

  /** Passes that find and sort the visible splats of a frame that is about to be submitted. */
  orderPasses(): readonly FramePass[] {
    this.context.counting.framesPrepared++;
    return this.parts.orderPasses;
  }

  /** Passes that draw the visible splats. @throws GpuLimitError */
  drawPasses(destination: Destination): readonly FramePass[] {
    return this.parts.drawPasses(destination, this.choice.sampleFor(this.last!, this.statistics));
  }

  /** Records the end of a drawn frame. */
  recordEnd(encoder: GPUCommandEncoder): void {
    this.drawnAs = ++this.context.counting.framesDrawn;
    this.parts.recordCounts(encoder);
  }

  /** Call when the frame of `request` has been submitted, or is drawn already. */
  onDrawn(request: FrameRequest): void {
    this.accuracy.onDrawn(request);
    this.#detail?.onDrawn(request);
    this.streams.onFrame();
  }

  /** Reads the frame's statistics; call after submitting. Null if it was not measured. */
  measure(submittedMs = performance.now()): Promise<FrameStatistics | null> {
    const measured = this.#measure(submittedMs);
    // Callers of `measure` get the error; `#measured` only tells when it is over.
    this.#measured = measured.catch(() => {});
    return measured;
  }

  /**
   * Compiles the shaders of frames like `request`, for small and large ranges of depth. Draws
   * nothing.
   */
  precompile(request: FrameRequest): void {
    const { shape } = this.#plan(request, this.context.accuracyFor(undefined), null);
    const keyBits = Math.min(LIKELY_KEY_BITS, shape.accuracy.sortKeyBits);
    // Wide keys of any number of bits use the same shaders.
    const others = hasWideKeys(shape) ? [] : [{ ...shape, keyBits }];
    for (const likely of [shape, ...others]) this.wait.isReadyOrCompiling(likely);
  }

  /** Frees the memory of the last frame and clears it. */
  startOver(): void {
    this.parts.destroy();
    this.parts = new FrameParts(this.context);
    this.recovery.forget();
    this.planner.forget();
  }

  /**
   * Ends the frames; returns false if they had already ended. Destroy `parts` when nothing uses
   * them.
   */
  end(): boolean {
    if (this.#isDestroyed) return false;
    this.#isDestroyed = true;
    this.accuracy.leave();
    this.#detail?.end();
    this.streams.leave();
    this.#onDestroyed();
    return true;
  }

  #plan(
    request: FrameRequest,
    accuracy: AccuracySettings,
    depth: RasterizeDepth | null,
    { detail, movingScale }: Partial<MovingFrame> = {},
  ): FramePlan {
    const faster = this.choice.rasterizerFor(depth);
    return this.planner.plan(request, {
      accuracy: scaled(accuracy, movingScale),
      movingScale,
      depth,
      faster,
      detail,
    });
  }

  /** Keeps the error of a shader. Returns whether the next plan does without what is to blame. */
  #canDrawWithout(error: Error, { request }: FramePlan): boolean {
    if (this.#isDestroyed || this.context.destroyedBecause() !== null) return false;
    if (error instanceof ShaderError && error.culprit) {
      const { faults } = this.context;
      const culprit = error.culprit as SplatEffect | EffectSet;
      if (!faults.has(culprit)) faults.set(culprit, error);
      return true;
    }
    if (error.message !== this.#lastMessage)
      this.#take({ error, clouds: request.clouds.map(({ cloud }) => cloud) });
    this.#lastMessage = error.message;
    return false;
  }

  /** Takes the first error of left out effects that the owner has not received. */
  #tellOfLeftOut({ clouds }: FramePlan): void {
    for (const { leftOut } of clouds) {
      for (const { error } of leftOut) {
        // The next plan has the others again.
        if (this.fault || this.#told.has(error)) continue;
        this.#told.add(error);
        const concerned = clouds.filter((cloud) => cloud.leftOut.some((each) => each.error === error));
        this.#take({ error, clouds: concerned.map(({ instance }) => instance.cloud) });
      }
    }
  }

  #take(fault: FrameFault): void {
    this.fault = fault;
    this.#drawing.onFault();
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
    this.#drawing.drawAgain(request);
    await this.context.device.queue.onSubmittedWorkDone();
  }

  /** Fetched on demand, because most views never find detail. Images are full until then. */
  async #loadDetail(): Promise<void> {
    try {
      const { ViewDetail } = await import('./view-detail.ts');
      const { targetFor, cutFinders } = this.context;
      const drawAgain = (request: FrameRequest) => this.#drawing.drawAgain(request);
      this.#detail = new ViewDetail({
        targetFor,
        cutFinders,
        asDrawn: (request) => ({ ...request, accuracy: this.parts.shape?.accuracy }),
        // Some browsers reject for a lost device, which ends the view by itself.
        whenDone: () => this.context.device.queue.onSubmittedWorkDone().catch(() => {}),
        drawAgain,
        precompile: (request, moving) => this.#precompileMoving(request, moving),
      });
      if (this.#isDestroyed) this.#detail.end();
      else if (this.last) drawAgain(this.last.request);
    } catch (error) {
      this.#lacksDetail = true;
      console.warn(`The pictures of a view stay full: ${(error as Error).message}`);
    }
  }

  #precompileMoving(request: FrameRequest, { detail, movingScale }: MovingFrame): void {
    if (!this.parts.shape || !this.canStillDraw(request)) return;
    const { depth, rasterizer, accuracy: drawn } = this.parts.shape;
    const accuracy = scaled(drawn, movingScale / (this.last?.movingScale ?? 1));
    const plan = this.planner.plan(request, { accuracy, movingScale, depth, faster: rasterizer, detail });
    // The frame itself reports errors.
    this.wait.whenReady(plan).catch(() => {});
  }

  #resume(request: FrameRequest | null): Promise<void> | null {
    if (request) this.checkUsable();
    return this.#isDestroyed ? null : this.#drawing.drawWaiting(request);
  }

  /** Draws a sound frame again. */
  async #restore({ request, shape, detail, movingScale }: FramePlan): Promise<void> {
    // Another frame may have been drawn since.
    if (this.last || !this.canStillDraw(request)) return;
    const { accuracy, depth, rasterizer } = shape;
    try {
      const settings = { accuracy, movingScale, depth, faster: rasterizer, detail };
      const again = this.planner.plan(request, settings);
      if (this.wait.isReady(again.shape)) await this.#drawing.draw(again);
    } catch {
      // Memory is lacking for the sound frame too; the view holds nothing.
    }
  }

  #drawSuccessor(again: FramePlan | null): Promise<void> | null {
    // `drawWaiting` may return `lastDrawn`, which is the very promise that awaits this call.
    if (!this.last) this.lastDrawn = RESOLVED;
    // A caller may have requested another frame meanwhile.
    return this.#drawing.drawWaiting(again && this.#newest === again ? again.request : null);
  }

  async #measure(submittedMs: number): Promise<FrameStatistics | null> {
    const drawn = this.last;
    const { clouds = [] } = this.parts.shape ?? {};
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
    if (!statistics || this.#isDestroyed || !this.last) return null;
    const { tilePairs, visibleSplats } = statistics;
    const { tileLists } = this.parts;
    if (tilePairs !== null) tileLists.expect(tilePairs, visibleSplats, performance.now());
    this.choice.addStatistics(
      this.last,
      statistics,
      tilePairs === null ? null : tileLists.whyTooMany(visibleSplats),
    );
    if (drawn) this.#detail?.addFrame(drawn, statistics);
    this.statistics = statistics;
    this.#reached = { detail: drawn?.detail ?? 'full', errorPx: statistics.cutErrorPx };
    // The last planned frame may lack this error, on which its sights depend.
    if (isSameDetail(this.#reached.detail, this.last.detail))
      this.streams.updateSights(this.last, this.#reached.errorPx);
    callListener(this.listeners.onStatistics, statistics);
    return statistics;
  }
}

function frameError({ message }: GPUError): InvalidArgumentError {
  return new InvalidArgumentError(
    'effects',
    `The device refused a frame whose effects read textures or buffers: ${message.split('\n')[0]}`,
  );
}

/** Settings with a part of their resolution, or the least that there is. */
function scaled(accuracy: AccuracySettings, movingScale = 1): AccuracySettings {
  if (movingScale === 1) return accuracy;
  const resolutionScale = Math.max(LEAST_RESOLUTION_SCALE, movingScale * accuracy.resolutionScale);
  return internAccuracy({ ...accuracy, resolutionScale });
}

/** Whether all clouds of `request` are confirmed to be on the GPU. */
function areUploaded({ clouds }: FrameRequest): boolean {
  return clouds.every(({ cloud }) => cloud.isUploaded);
}
