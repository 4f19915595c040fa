import type { AccuracySettings } from '../accuracy/accuracy.ts';
import { checkAccuracy } from '../accuracy/accuracy-target.ts';
import { DestroyedError, type GpuLimitError, InvalidArgumentError } from '../errors.ts';
import { effectsOf } from '../frame/cloud-plan.ts';
import { FrameParts, frameStages } from '../frame/frame.ts';
import type { Destination, QuadsSample } from '../frame/frame-part.ts';
import { type FramePlan, planFrame, showsClouds } from '../frame/frame-plan.ts';
import { checkRequest, type FrameRequest } from '../frame/frame-request.ts';
import type { FrameOutput, FrameShape } from '../frame/frame-shape.ts';
import { isSameColors, isSameOrder } from '../frame/plan-difference.ts';
import { RecentNeeds } from '../frame/recent-needs.ts';
import type { BallotDevice } from '../gpu/device.ts';
import type { Counting } from '../gpu/engine-counters.ts';
import type { GpuMemory, GpuMemoryReport } from '../gpu/gpu-memory.ts';
import type { Pipelines, StageDefinition } from '../gpu/pipelines.ts';
import { type EffectEntry, effectsLedger } from '../ledger/ledger.ts';
import type { AccuracyChoice } from '../measure/choose-accuracy.ts';
import { isSameDepth, type RasterizeDepth } from '../stages/rasterize.ts';
import type { FrameStatistics } from '../timing/frame-statistics.ts';
import { GpuTimer } from '../timing/gpu-timer.ts';
import type { ChooseAccuracyOptions } from './accuracy-targets.ts';
import type { PointCoverage, PointToCover } from './find-coverage.ts';
import type { SplatPick } from './pick-splat.ts';
import {
  RasterizerChoice,
  type RasterizerChoiceOptions,
  type RasterizerReport,
} from './rasterizer-choice.ts';
import { type AccuracyContext, ViewAccuracy } from './view-accuracy.ts';

/** The parts of an engine that a view needs. */
export interface ViewContext extends AccuracyContext {
  readonly device: GPUDevice;
  readonly pipelines: Pipelines;
  /** Counts what the view holds, by itself and in the engine's. */
  readonly memory: GpuMemory;
  readonly counting: Counting;
  readonly dispatchRow: number;
  readonly workgroupBytes: number;
  readonly hasNarrowSubgroups: boolean;
  /** The device, once ranking keys by ballots has been found faster there; else null. */
  readonly ballots: () => BallotDevice | null;
  /** Called when a frame has been measured. */
  readonly onMeasured: () => void;
  readonly tileBudgetBytes: number;
  readonly submissionBudgetMs: number;
  /** The rasteriser that was faster on this adapter before, and where to keep that. */
  readonly fasterRasterizer: Pick<RasterizerChoiceOptions, 'remembered' | 'remember'>;
  /** Returns why nothing can be drawn any more, or null. */
  readonly destroyedBecause: () => string | null;
}

/** The frame that a view draws in response to a request. */
export interface NextFrame {
  /**
   * The plan to draw: the requested one or, while its shaders compile, the same clouds with the settings and effects of the
   * last frame. Null if there is nothing to draw until then.
   */
  readonly plan: FramePlan | null;
  /** Whether that frame is shown already, so that there is nothing to draw. */
  readonly stands: boolean;
  /**
   * Whether `plan` is the requested one. If not, shaders are compiling, clouds are being uploaded or memory is sought and
   * `retry` will be called, or a preview is held, which another will replace.
   */
  readonly isAsked: boolean;
}

/** Shortest time between two probes for memory that was lacking, ms: a page may ask for the same frame sixty times a second. */
const PROBE_PAUSE_MS = 250;

/** Bits in which the depths of most scenes differ that a camera stands in. */
const LIKELY_KEY_BITS = 27;

let picking: typeof import('./pick-splat.ts') | null = null;

/**
 * Base class of views, whatever they draw into: plans frames, waits for shaders, applies the settings chosen for a target,
 * gathers statistics and picks splats. Subclasses decide when a frame is drawn and where its image goes.
 */
export abstract class ViewCore {
  /** Called with the statistics of each measured frame, some frames later. */
  onStatistics: ((statistics: FrameStatistics) => void) | null = null;
  /**
   * Called when settings have been chosen for a target (`accuracy: { minPsnrDb: 45 }`). Measuring takes seconds and begins half
   * a second after the first frame, and after the last change of its size. A scene is measured again when its clouds change,
   * but not when the camera moves. A `SplatView` has already drawn its last frame again with the choice; an `EmbeddedView`
   * has called `onReady`, for its host to prepare the frame again.
   */
  onAccuracyChosen: ((choice: AccuracyChoice) => void) | null = null;
  /** @internal Whether round splats may have shaders of their own; false to measure without them. */
  mayBeIsotropic = true;
  /** Whether the device has not yet said if it had memory for the last frames. */
  protected isChecking = false;
  protected readonly context: ViewContext;
  protected parts: FrameParts;
  protected timer: GpuTimer;
  readonly #output: FrameOutput;
  readonly #accuracy: ViewAccuracy;
  readonly #onDestroyed: () => void;
  /** The faster rasteriser, for the setting `auto`. */
  readonly #choice: RasterizerChoice;
  /** What the buffers and shaders of the next frame should suit, besides that frame. */
  #needs = new RecentNeeds();
  /** Why the last frame could not be drawn, until a caller has been told. */
  #unreportedError: Error | null = null;
  /** The frame that found no memory, as long as none so large has. */
  #lack: Lack | null = null;
  /** Whether the last requested frame waits for memory, which may be lacking still. */
  protected isLackingRoom = false;
  /** The plan of the newest request; null if that is not drawn yet. */
  #asked: FramePlan | null = null;
  /** Settles when the device has said whether it had memory for the last frames; rejects if not. */
  #checking: Promise<void> = Promise.resolve();
  #newestCheck = 0;
  /** The last frame for which there was memory, and the one before: to divide a frame takes memory, too. */
  #sound: FramePlan | null = null;
  #soundBefore: FramePlan | null = null;
  #prepared: FramePlan | null = null;
  /** Whether the frame being drawn has the visible splats of the last one, in the same order. */
  #isColorsOnly = false;
  #wait: Wait | null = null;
  #whenDrawn: Promise<void> = Promise.resolve();
  /** The drawn shape whose expected successor has its shaders already; see `expect`. */
  #expectedAfter: FrameShape | null = null;
  /** Shapes whose shaders have been compiled. */
  readonly #ready = new WeakSet<FrameShape>();
  #frameNumber = 0;
  #drawnAs = 0;
  #statistics: FrameStatistics | null = null;
  #isDestroyed = false;

  protected constructor(context: ViewContext, output: FrameOutput, onDestroyed: () => void) {
    this.context = context;
    this.#output = output;
    this.#onDestroyed = onDestroyed;
    this.parts = this.#newParts();
    this.timer = this.#newTimer();
    this.#choice = new RasterizerChoice({
      hasTimestamps: context.device.features.has('timestamp-query'),
      ...context.fasterRasterizer,
    });
    this.#accuracy = new ViewAccuracy(context, (choice, request) => this.onChosen(choice, request));
  }

  /** The newest statistics, or null before the first. */
  get statistics(): FrameStatistics | null {
    return this.#statistics;
  }

  /** The last choice for the target; null before the first choice, and if settings were requested. */
  get accuracyChoice(): AccuracyChoice | null {
    return this.#accuracy.choice;
  }

  /**
   * Measures the last frame now, and chooses the settings that meet its target again: for all views with the same target and the
   * same clouds, at the size of the largest.
   *
   * @throws InvalidArgumentError if there is no frame yet, or it was drawn without a target; DestroyedError; an AbortError if
   *   the view is destroyed or a later call takes over; the signal's reason. On failure the settings stay.
   */
  async chooseAccuracy(options: ChooseAccuracyOptions = {}): Promise<AccuracyChoice> {
    this.checkUsable();
    return this.#accuracy.choose(options);
  }

  /**
   * Returns the splat that contributes most to a pixel of the last image, whatever another renderer draws in front of it;
   * null if there is none, outside the image, and before the first frame.
   *
   * @param xPx, yPx from the top left of the image; a fractional position belongs to the pixel that contains it.
   * @throws DestroyedError if the view or its engine ends before the result is read.
   */
  async pick(xPx: number, yPx: number): Promise<SplatPick | null> {
    this.checkUsable();
    // Most pages never pick. Once the code is there, the frame that stands now is the one that is searched.
    picking ??= await import('./pick-splat.ts');
    const { pickStage, pickInImage } = picking;
    return this.#search(pickStage, (plan) => pickInImage(this.context, this.parts, plan, xPx, yPx));
  }

  /**
   * Returns what is in front of each of at most 1,024 points of the world in the last frame: splats, and opaque objects of the
   * renderer that the view is embedded in. One small read-back for all of them. Null before the first frame.
   *
   * @throws InvalidArgumentError for too many points and numbers that are not finite; GpuLimitError if memory is lacking;
   *   DestroyedError if the view or its engine ends before the result is read.
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

  /** Runs `find` over the last frame, as soon as the stage that it needs is compiled; null without a frame. */
  async #search<Found>(
    stageOf: (plan: FramePlan) => StageDefinition,
    find: (plan: FramePlan, stage: StageDefinition) => Promise<Found>,
  ): Promise<Found | null> {
    const { pipelines } = this.context;
    while (this.#prepared && !this.#isDestroyed) {
      const stage = stageOf(this.#prepared);
      if (pipelines.areReady([stage])) return find(this.#prepared, stage);
      // While the stage compiles, a frame with other records may be drawn, or the view destroyed.
      await pipelines.prepare([stage]);
    }
    return null;
  }

  /**
   * Lists all effects of the last frame, on and off, with the reason; empty before the first frame. While shaders for other
   * effects compile, the last frame has the old effects.
   */
  effects(): readonly EffectEntry[] {
    if (!this.#prepared) return [];
    const { memory } = this.context;
    const { shared, preprocess, resolveDepth, compose, tileLists } = this.parts;
    const bytesOf = (each: readonly (GPUBuffer | GPUTexture | null | undefined)[]) =>
      [...new Set(each)].reduce((sum, resource) => sum + memory.bytesOf(resource), 0);
    const held = {
      selectionBytes: (cloudIndex: number) => preprocess.selectionBytes(cloudIndex),
      testedDepthBytes: bytesOf([shared.hostDepth]) + resolveDepth.bytes,
      writtenDepthBytes: bytesOf([
        shared.image?.depthLayer,
        shared.blended?.depthLayer,
        compose.image?.depth,
      ]),
      tilesBytes: tileLists.bytes,
    };
    return effectsLedger({ plan: this.#prepared, held, rasterizer: this.rasterizer });
  }

  /** The rasteriser of this view, and the times of both as far as they are known. */
  get rasterizer(): RasterizerReport {
    const drawn = this.shape;
    const { report } = this.#choice;
    if (!drawn) return report;
    const { rasterizer, accuracy, depth } = drawn;
    if (rasterizer === accuracy.rasterizer) {
      return { ...report, rasterizer, reason: `${rasterizer} were asked for` };
    }
    if (depth?.layerFormat && rasterizer !== report.rasterizer) {
      const isTiles = rasterizer === 'tiles';
      const reason = isTiles
        ? 'only tiles write the median of depth'
        : 'tiles cannot write depth on this device';
      return { ...report, rasterizer, reason };
    }
    return report;
  }

  /** @internal Number of the last frame among all frames of the engine; 0 before the first. */
  get drawnAs(): number {
    return this.#drawnAs;
  }

  /** @internal GPU memory of the view. */
  get memory(): GpuMemoryReport {
    return this.context.memory.report();
  }

  /** @internal Shape of the last frame; null before the first. */
  get shape(): FrameShape | null {
    return this.parts.shape;
  }

  /** Plan of the last frame; null before the first. */
  protected get prepared(): FramePlan | null {
    return this.#prepared;
  }

  protected get isDestroyed(): boolean {
    return this.#isDestroyed;
  }

  /** See `SplatView.whenDrawn`. */
  protected get drawn(): Promise<void> {
    return this.#whenDrawn.then(() => {
      if (this.#unreportedError) throw this.#unreportedError;
      return this.#checking;
    });
  }

  /** Whether a request waits for its shaders. */
  protected get isWaiting(): boolean {
    return this.#wait !== null;
  }

  protected canStillDraw({ clouds }: FrameRequest): boolean {
    const isUsable = !this.#isDestroyed && this.context.destroyedBecause() === null;
    return isUsable && clouds.every(({ cloud }) => !cloud.isDestroyed);
  }

  /** Draws the last sound frame again, or what takes the place of one that found no memory. */
  protected abstract redraw(plan: FramePlan): void;

  /** Called when settings have been chosen for a target; `request` is that of the last frame. */
  protected abstract onChosen(choice: AccuracyChoice, request: FrameRequest): void;

  /**
   * Called when shaders that a request lacked have been compiled.
   *
   * @param request the newest one, which still waits: draw it, or wait for further shaders. Null if another was drawn meanwhile.
   * @returns whether a frame follows.
   */
  protected abstract retry(request: FrameRequest | null): boolean;

  /**
   * Checks a request.
   *
   * @returns whether it has pixels.
   * @throws InvalidArgumentError naming the invalid argument and the reason, DestroyedError for a destroyed cloud,
   *   GpuLimitError for a cloud that found no memory.
   */
  protected check(request: FrameRequest): boolean {
    checkRequest(request, this.context.device);
    // Before anything is planned: another size may need other shaders.
    checkSize(this.context.device, request.widthPx, request.heightPx);
    if (request.widthPx > 0 && request.heightPx > 0) return true;
    // Without pixels there is no plan, which would check these.
    for (const instance of request.clouds) effectsOf(instance);
    const { accuracy } = request;
    if (accuracy) checkAccuracy(accuracy);
    return false;
  }

  /** @throws GpuLimitError, once, if the last frame found no memory. */
  protected tellLack(): void {
    const unreported = this.#takeUnreportedError();
    if (unreported) throw unreported;
  }

  /**
   * Plans a frame, and compiles its missing shaders.
   *
   * @param depths the requested depth test, then the alternatives to draw with while its shaders compile.
   */
  protected next(
    request: FrameRequest,
    depths: readonly [RasterizeDepth | null, ...(RasterizeDepth | null)[]],
  ): NextFrame {
    this.isLackingRoom = false;
    for (const { cloud } of request.clouds) cloud.editing?.flush();
    if (request.clouds.some(({ cloud }) => cloud.isHeld)) {
      const last = this.#prepared;
      return { plan: last, stands: last !== null, isAsked: false };
    }
    const asked = this.#plan(request, this.#accuracy.settingsFor(request), depths[0]);
    if (!request.force && this.#isPrepared(asked)) {
      this.#endWait();
      return { plan: asked, stands: true, isAsked: true };
    }
    this.#asked = null;
    const plan = this.#withCompiledRasterizer(asked, depths[0]);
    if (this.#lack && isAsLarge(plan, this.#lack)) {
      this.isLackingRoom = true;
      const last = this.#prepared;
      if (performance.now() - this.#lack.probedMs > PROBE_PAUSE_MS) this.#waitFor(plan, request);
      return { plan: last, stands: last !== null, isAsked: false };
    }
    if (this.#isReady(plan.shape) && areUploaded(request)) {
      this.#endWait();
      this.#asked = plan;
      return { plan, stands: false, isAsked: true };
    }
    this.#waitFor(plan, request);
    const stopgap = this.#stopgapFor(plan, depths);
    return { plan: stopgap, stands: stopgap !== null && this.#isPrepared(stopgap), isAsked: false };
  }

  /**
   * Compiles the shaders of a shape that may follow the drawn one, so that they are ready then.
   *
   * @param change returns the expected shape for the drawn one.
   */
  protected expect(drawn: FrameShape, change: (drawn: FrameShape) => FrameShape): void {
    if (this.#expectedAfter === drawn) return;
    const shape = change(drawn);
    if (this.#isReady(shape)) this.#expectedAfter = drawn;
    else this.context.pipelines.prepare(frameStages(shape)).catch(() => {});
  }

  /** Compiles the shaders of frames like `request`, for depths near and far, without drawing any. */
  protected foresee(request: FrameRequest): void {
    const { shape } = this.#plan(request, this.context.accuracyFor(undefined), null);
    const keyBits = Math.min(LIKELY_KEY_BITS, shape.accuracy.sortKeyBits);
    for (const likely of [shape, { ...shape, keyBits }])
      this.context.pipelines.prepare(frameStages(likely)).catch(() => {});
  }

  /**
   * Makes room for a frame, and records and submits it by `work`. If memory is lacking for it, which the device tells later, the
   * last frame is drawn again.
   *
   * @returns what rejects if memory was lacking; null if the frame takes no more than those before.
   * @throws GpuLimitError if limits or the engine's budget do not allow the frame; the last one stays, or is drawn again.
   */
  protected withMemory(plan: FramePlan, work: () => void): Promise<void> | null {
    const { parts } = this;
    const advice = 'Draw a smaller image, or with a coarser accuracy or by quads, or load fewer splats.';
    let checked: Promise<void> | null;
    try {
      // A frame in memory that is still being checked may be as invalid as that.
      ({ checked } = this.context.memory.guard('A frame', advice, work, this.isChecking));
    } catch (error) {
      if (parts.isDestroyed) {
        void this.#restore(this.#takeLack(error as Error, plan));
        this.#unreportedError = null;
      }
      throw error;
    }
    if (!checked) {
      this.#takeSound(this.#prepared);
      return null;
    }
    const check = ++this.#newestCheck;
    this.isChecking = true;
    const checking: Promise<void> = checked.then(
      () => {
        if (check === this.#newestCheck) this.isChecking = false;
        if (parts === this.parts) this.#takeSound(plan);
      },
      (error: Error) => this.giveUp(error, plan, parts, checking),
    );
    checking.catch(() => {});
    this.#checking = checking;
    return checked;
  }

  /**
   * Frees a frame that found no memory, draws the last one for which there was some, and lets another take its place: the
   * newest request, or the same one by quads.
   *
   * @param parts those of the frame.
   * @param checking what settles with this.
   * @throws `error` if none follows; else why that one could not be drawn.
   */
  protected async giveUp(
    error: Error,
    plan: FramePlan,
    parts: FrameParts,
    checking?: Promise<void>,
  ): Promise<void> {
    if (this.#isDestroyed) return;
    // Frames that followed in the same memory are void for the same reason.
    if (parts !== this.parts) throw this.#unreportedError ?? error;
    const sound = this.#takeLack(error, plan);
    const { reclaimMemory } = await import('../gpu/probe-memory.ts');
    await reclaimMemory(this.context.device);
    await this.#restore(sound);
    if (this.#isDestroyed) return;
    // Nothing may follow that is checked, and this must not wait for itself.
    if (this.#checking === checking) this.#checking = Promise.resolve();
    const isByChoice = hasChosenTiles(plan);
    // A caller may have asked for another one meanwhile.
    const follows = this.retry(isByChoice && this.#asked === plan ? plan.request : null);
    // Then this was not the last one.
    if (follows) this.#takeUnreportedError();
    else if (!isByChoice) throw error;
    await this.drawn;
  }

  #takeSound(plan: FramePlan | null): void {
    if (plan !== this.#sound) this.#soundBefore = this.#sound;
    this.#sound = plan;
  }

  /** Gives up the memory of a frame that lacks some. @returns the frame to draw again instead. */
  #takeLack(error: Error, plan: FramePlan): FramePlan | null {
    const sound = this.#sound === plan ? this.#soundBefore : this.#sound;
    const bytes = Math.max(this.memory.totalBytes, (error as GpuLimitError).neededBytes ?? 0);
    this.startOver();
    if (hasChosenTiles(plan)) {
      const [visibleSplats, pixels] = sizesOf(plan);
      this.#choice.rejectTiles('tiles found no memory for their lists', { visibleSplats, pixels });
    } else {
      this.#unreportedError ??= error;
      this.#lack ??= { sizes: sizesOf(plan), bytes, error, probedMs: Number.NEGATIVE_INFINITY };
    }
    return sound;
  }

  /** Draws the last sound frame again. @returns what settles when it is known whether there was memory for that. */
  async #restore(sound: FramePlan | null): Promise<void> {
    // Another frame may have been drawn since.
    if (!sound || this.#prepared || !this.canStillDraw(sound.request)) return;
    const { accuracy, depth, rasterizer } = sound.shape;
    const again = this.#plan(sound.request, accuracy, depth, rasterizer);
    try {
      if (!this.#isReady(again.shape)) return;
      this.redraw(again);
      await this.#checking;
    } catch {
      // Then there is no memory for that either, and the view holds nothing.
    }
  }

  /**
   * Makes room for a frame and writes its uniforms. Call within `withMemory`, before recording.
   *
   * @throws GpuLimitError
   */
  protected makeRoom(plan: FramePlan): void {
    const last = this.#prepared;
    const isOrderKept =
      !plan.request.force &&
      last !== null &&
      // The other rasteriser has not filled its buffers.
      last.shape.rasterizer === plan.shape.rasterizer &&
      isSameOrder(last, plan);
    const isReplaced = this.parts.fit(plan);
    if (last && !showsClouds(last, plan.request.clouds)) this.#needs = new RecentNeeds();
    this.#needs.take(plan.needs, performance.now());
    this.#isColorsOnly = isOrderKept && !isReplaced;
    this.#prepared = plan;
  }

  #newParts(): FrameParts {
    return new FrameParts(this.context);
  }

  #newTimer(): GpuTimer {
    return new GpuTimer(this.context.device, this.context.memory);
  }

  /** Forgets the last frame and frees its memory. */
  protected startOver(): void {
    this.free();
    this.parts = this.#newParts();
    this.timer = this.#newTimer();
    this.isChecking = false;
    this.#sound = this.#soundBefore = null;
    this.#prepared = null;
    this.#needs = new RecentNeeds();
    this.#expectedAfter = null;
  }

  protected recordOrder(encoder: GPUCommandEncoder): void {
    this.parts.recordOrder(encoder, this.timer, this.#isColorsOnly);
    this.context.counting.framesPrepared++;
  }

  protected recordDraw(encoder: GPUCommandEncoder, destination: Destination): void {
    this.parts.recordDraw(encoder, this.timer, destination, this.#sample());
    this.recordEnd(encoder);
  }

  /** Records what belongs to the end of a frame that has been drawn. */
  protected recordEnd(encoder: GPUCommandEncoder): void {
    this.#drawnAs = ++this.context.counting.framesDrawn;
    const { slotCount, visibleCount, tilePlan } = this.parts.shared.buffers;
    const hasTiles = this.shape?.rasterizer === 'tiles';
    this.timer.record(encoder, { slotCount, visibleCount, ...(hasTiles && { tilePlan }) });
  }

  /** Call when the frame of `request` has been drawn, or was shown already. */
  protected shown(request: FrameRequest): void {
    this.#accuracy.show(request);
  }

  /** Reads the frame's statistics; call after submitting. Null if it was not measured. */
  protected async measure(submittedMs = performance.now()): Promise<FrameStatistics | null> {
    const totalSplats = this.shape?.clouds.reduce((sum, { cloud }) => sum + cloud.count, 0) ?? 0;
    const read = () => this.timer.read(++this.#frameNumber, totalSplats, submittedMs);
    // What is read may turn out not to exist.
    const statistics = await this.context.memory.guard('A frame', '', read, this.isChecking).result;
    if (!statistics || this.#isDestroyed || !this.#prepared) return null;
    this.#learn(statistics);
    this.context.onMeasured();
    this.#statistics = statistics;
    this.onStatistics?.(statistics);
    return statistics;
  }

  /** Learns from a frame's statistics how much room the next one needs, and which rasteriser is faster. */
  #learn({ tilePairs, rasterizer, quadsSampleMs, visibleSplats, timing }: FrameStatistics): void {
    const { tileLists } = this.parts;
    const { shape } = this;
    if (tilePairs !== null) tileLists.expect(tilePairs, performance.now());
    if (shape?.accuracy.rasterizer !== 'auto') return;
    const pixels = this.#prepared!.layer.widthPx * this.#prepared!.layer.heightPx;
    const reason = tilePairs === null ? null : tileLists.whyTooMany(tilePairs);
    if (reason !== null) this.#choice.rejectTiles(reason, { visibleSplats, pixels });
    // A frame without room for its pairs has run the stages of both.
    if (tilePairs !== null && rasterizer === 'quads') return;
    const elapsedMs = timing.source === 'gpu-timestamps' ? timing.rasterizeMs : timing.wallClockMs;
    this.#choice.take({ rasterizer, elapsedMs, visibleSplats, pixels, sampleMs: quadsSampleMs });
  }

  /** The sample of the quads that the next frame is to draw besides its image. */
  #sample(): QuadsSample | null {
    const share = this.#choice.sampleShare;
    if (share === null || !this.#statistics || this.shape?.accuracy.rasterizer !== 'auto') return null;
    return { share, visibleSplats: this.#statistics.visibleSplats };
  }

  /** Ends the view, unless it has ended already. Call `free` when nothing uses its GPU memory any more. */
  protected end(): boolean {
    if (this.#isDestroyed) return false;
    this.#isDestroyed = true;
    this.#accuracy.leave();
    this.#onDestroyed();
    return true;
  }

  protected free(): void {
    this.parts.destroy();
    this.timer.destroy();
  }

  /** @throws DestroyedError */
  protected checkUsable(): void {
    const reason = this.#isDestroyed ? 'it was destroyed' : this.context.destroyedBecause();
    if (reason !== null) throw new DestroyedError('This view', reason);
  }

  #plan(
    request: FrameRequest,
    accuracy: AccuracySettings,
    depth: RasterizeDepth | null,
    faster = depth?.layerFormat ? this.#choice.forDepth : this.#choice.rasterizer,
  ): FramePlan {
    return planFrame(request, {
      accuracy,
      depth,
      faster,
      dispatchRow: this.context.dispatchRow,
      workgroupBytes: this.context.workgroupBytes,
      hasNarrowSubgroups: this.context.hasNarrowSubgroups,
      ballots: this.context.ballots(),
      output: this.#output,
      mayBeIsotropic: this.mayBeIsotropic,
      last: this.#prepared,
      recent: this.#needs.value,
    });
  }

  /** While the shaders of the other rasteriser compile, the one of the last frame goes on. */
  #withCompiledRasterizer(plan: FramePlan, depth: RasterizeDepth | null): FramePlan {
    const { shape, request } = plan;
    const last = this.shape;
    if (!last || shape.accuracy.rasterizer !== 'auto' || shape.rasterizer === last.rasterizer) return plan;
    if (this.#isReady(shape)) return plan;
    this.context.pipelines.prepare(frameStages(shape)).catch(() => {});
    return this.#plan(request, shape.accuracy, depth, last.rasterizer);
  }

  /** Whether the last frame is the one that `plan` would draw. */
  #isPrepared(plan: FramePlan): boolean {
    const last = this.#prepared;
    return (
      last !== null &&
      isSameDepth(last.shape.depth, plan.shape.depth) &&
      isSameOrder(last, plan) &&
      isSameColors(last, plan)
    );
  }

  /**
   * Plans the same frame with the settings and effects of the last one, so that the view keeps moving while shaders compile.
   * Null if there is no last frame, if it had other clouds, or if this plan lacks shaders too. The last frame itself if it had
   * previews.
   */
  #stopgapFor({ request, shape }: FramePlan, depths: readonly (RasterizeDepth | null)[]): FramePlan | null {
    const last = this.#prepared;
    if (!last || last.clouds.length !== request.clouds.length) return null;
    const { depth } = last.shape;
    if (!depths.some((possible) => isSameDepth(possible, depth))) return null;
    const lastClouds = last.shape.clouds.map(({ cloud }) => cloud);
    // Nothing new can be drawn of a preview that has been replaced, but its image is there.
    if (request.clouds.some(({ cloud }, i) => cloud !== lastClouds[i]))
      return lastClouds.some(({ isPreview }) => isPreview) ? last : null;
    const clouds = request.clouds.map((instance, i) => {
      const { opacity, effects, shDegree } = last.clouds[i].instance;
      const drawn = last.shape.clouds[i].effects;
      if (shape.clouds[i].effects === drawn) return { ...instance, shDegree };
      // A new selection may have turned an effect on since the last frame.
      const before = effects?.filter(
        ({ effect, reason }) => reason === null || drawn.effects.includes(effect),
      );
      return { ...instance, shDegree, opacity, effects: before };
    });
    const { sortBy } = last.request;
    const plan = this.#plan({ ...request, clouds, sortBy }, last.shape.accuracy, depth);
    return this.#isReady(plan.shape) ? plan : null;
  }

  #isReady(shape: FrameShape): boolean {
    if (this.#ready.has(shape)) return true;
    const isReady = this.context.pipelines.areReady(frameStages(shape));
    if (isReady) this.#ready.add(shape);
    return isReady;
  }

  /** Compiles the shaders of `plan`. If a request waits already, `request` takes its place instead. */
  #waitFor(plan: FramePlan, request: FrameRequest): void {
    const seeksRoom = this.isLackingRoom;
    // One that is smaller does not wait for memory that may not be found.
    if (this.#wait?.seeksRoom === seeksRoom) {
      this.#wait.request = request;
      return;
    }
    this.#wait = { request, seeksRoom };
    this.#whenDrawn = this.#retryWhenCompiled(this.#wait, plan);
    // The device itself reports a shader that does not compile; callers that do not await the frame get no second error.
    this.#whenDrawn.catch(() => {});
  }

  async #retryWhenCompiled(wait: Wait, { shape, request }: FramePlan): Promise<void> {
    let isWaiting = true;
    try {
      const uploads = request.clouds.map(({ cloud }) => cloud.uploaded);
      await Promise.all([
        this.context.pipelines.prepare(frameStages(shape)),
        wait.seeksRoom && this.#findRoom(),
        ...uploads,
      ]);
      isWaiting = this.#wait === wait;
      if (isWaiting) {
        this.#wait = null;
        this.checkUsable();
      }
      if (!this.#isDestroyed) this.retry(isWaiting ? wait.request : null);
    } finally {
      if (this.#wait === wait) this.#wait = null;
    }
    // By now the newest request may wait for other shaders.
    if (isWaiting && this.#wait) await this.#whenDrawn;
  }

  /** Asks whether there is memory by now. @throws the error of the frame that lacked it, if not. */
  async #findRoom(): Promise<void> {
    const lack = this.#lack;
    if (!lack) return;
    lack.probedMs = performance.now();
    // Few pages ever lack memory.
    const { probeMemory } = await import('../gpu/probe-memory.ts');
    const isThere = await probeMemory(this.context.memory, lack.bytes - this.memory.totalBytes);
    if (!isThere) throw lack.error;
    this.#lack = null;
  }

  #endWait(): void {
    this.#wait = null;
    this.#whenDrawn = Promise.resolve();
    // The last frame is another one now.
    this.#takeUnreportedError();
  }

  #takeUnreportedError(): Error | null {
    const unreported = this.#unreportedError;
    this.#unreportedError = null;
    if (unreported) this.#checking = Promise.resolve();
    return unreported;
  }
}

/** A request that waits for shaders, clouds or memory. */
interface Wait {
  /** The newest request. */
  request: FrameRequest;
  /** Whether it waits for memory, too. */
  readonly seeksRoom: boolean;
}

/** A frame that found no memory. */
interface Lack {
  readonly sizes: readonly number[];
  /** Bytes that the view would hold with that frame. */
  readonly bytes: number;
  readonly error: Error;
  /** When it was last asked whether there is memory by now. */
  probedMs: number;
}

/** Whether a plan has tiles that were not asked for. */
function hasChosenTiles({ shape }: FramePlan): boolean {
  return shape.rasterizer === 'tiles' && shape.accuracy.rasterizer === 'auto';
}

/** What decides how much memory a frame needs: visible splats, pixels of the layer, pixels of the image, and whether by tiles. */
function sizesOf({ shape, layer, request }: FramePlan): readonly number[] {
  const hasTiles = Number(shape.rasterizer === 'tiles');
  return [
    shape.visibleCapacity,
    layer.widthPx * layer.heightPx,
    request.widthPx * request.heightPx,
    hasTiles,
  ];
}

/** Whether `plan` needs as much memory as the frame that found none. */
function isAsLarge(plan: FramePlan, { sizes }: Lack): boolean {
  return sizesOf(plan).every((size, i) => size >= sizes[i]);
}

/** Whether all clouds of `request` are known to be on the GPU. */
function areUploaded({ clouds }: FrameRequest): boolean {
  return clouds.every(({ cloud }) => cloud.isUploaded);
}

function checkSize({ limits }: GPUDevice, widthPx: number, heightPx: number): void {
  const limit = limits.maxTextureDimension2D;
  if (Math.max(widthPx, heightPx) <= limit) return;
  const message = `An image of ${widthPx}×${heightPx} px is larger than this device's ${limit} px (maxTextureDimension2D).`;
  throw new InvalidArgumentError('widthPx', message);
}
