import type { AccuracySettings } from '../accuracy/accuracy.ts';
import { DestroyedError, InvalidArgumentError } from '../errors.ts';
import { effectsOf } from '../frame/cloud-plan.ts';
import { FrameParts, frameStages } from '../frame/frame.ts';
import type { Destination } from '../frame/frame-part.ts';
import { type FramePlan, planFrame, withKeptColors } from '../frame/frame-plan.ts';
import { checkRequest, type FrameRequest } from '../frame/frame-request.ts';
import type { FrameOutput, FrameShape, OmittableEffect } from '../frame/frame-shape.ts';
import { canKeepColors } from '../frame/parts/kept-colors.ts';
import { isSameColors, isSameOrder } from '../frame/plan-difference.ts';
import type { Counting } from '../gpu/engine-counters.ts';
import type { GpuMemory } from '../gpu/gpu-memory.ts';
import type { Pipelines } from '../gpu/pipelines.ts';
import { type EffectEntry, effectsLedger } from '../ledger/ledger.ts';
import type { AccuracyChoice } from '../measure/choose-accuracy.ts';
import { pick } from '../stages/pick.ts';
import { isSameDepth, type RasterizeDepth } from '../stages/rasterize.ts';
import type { FrameStatistics } from '../timing/frame-statistics.ts';
import { GpuTimer } from '../timing/gpu-timer.ts';
import type { ChooseAccuracyOptions } from './accuracy-wishes.ts';
import { pickSplat, type SplatPick } from './pick-splat.ts';
import { type AccuracyContext, ViewAccuracy } from './view-accuracy.ts';

/** What a view needs of its engine. */
export interface ViewContext extends AccuracyContext {
  readonly device: GPUDevice;
  readonly pipelines: Pipelines;
  readonly memory: GpuMemory;
  readonly counting: Counting;
  readonly dispatchRow: number;
  /** Why nothing can be drawn any more, or null. */
  readonly destroyedBecause: () => string | null;
}

/** What a view does with a frame that it was asked for. */
export interface NextFrame {
  /**
   * The plan to draw: the one that was asked for; or, while its shaders compile, the same clouds with the settings and effects
   * of the last frame; null where there is nothing to draw before that.
   */
  readonly plan: FramePlan | null;
  /** Whether that frame stands already: there is nothing to draw. */
  readonly stands: boolean;
  /** Whether it is the one that was asked for. Where not, its shaders are being compiled: `retry` follows. */
  readonly isAsked: boolean;
}

/**
 * What views have in common, whatever they draw into: planning frames, waiting for shaders, settings that follow from a wish,
 * statistics, picking. Views decide when a frame is drawn and what becomes of it.
 */
export abstract class ViewCore {
  /** Called some frames after each frame that was measured. */
  onStatistics: ((statistics: FrameStatistics) => void) | null = null;
  /**
   * Called when settings have been chosen because of a wish (`accuracy: { minPsnrDb: 45 }`). Measuring takes seconds and begins
   * half a second after the first frame, and after the last change of its size. A scene is measured again when its clouds
   * change, and not when the camera moves. The last frame has been drawn again with the choice by then, or, inside another
   * renderer's frame, follows when `onReady` has been heard.
   */
  onAccuracyChosen: ((choice: AccuracyChoice) => void) | null = null;
  protected readonly context: ViewContext;
  protected readonly parts: FrameParts;
  protected readonly timer: GpuTimer;
  readonly #output: FrameOutput;
  readonly #accuracy: ViewAccuracy;
  readonly #onDestroyed: () => void;
  #omittedEffects: readonly OmittableEffect[] = [];
  #prepared: FramePlan | null = null;
  /** Whether the frame that is being drawn has the visible splats of the one before, in the same order. */
  #isColorsOnly = false;
  #wait: Wait | null = null;
  #whenDrawn: Promise<void> = Promise.resolve();
  /** By reason, the shape whose change has its shaders already: see `expect`. */
  readonly #expected = new Map<string, FrameShape>();
  /** Shapes whose shaders are there. */
  readonly #ready = new WeakSet<FrameShape>();
  #frameNumber = 0;
  #drawnAs = 0;
  #statistics: FrameStatistics | null = null;
  #isDestroyed = false;

  protected constructor(context: ViewContext, output: FrameOutput, onDestroyed: () => void) {
    this.context = context;
    this.#output = output;
    this.#onDestroyed = onDestroyed;
    this.parts = new FrameParts(context);
    this.timer = new GpuTimer(context.device, context.memory);
    this.#accuracy = new ViewAccuracy(context, (choice, request) => this.onChosen(choice, request));
  }

  /** The newest measurement, or null before the first. */
  get statistics(): FrameStatistics | null {
    return this.#statistics;
  }

  /** The settings chosen because of a wish; null before the first choice, and where settings are asked for. */
  get accuracyChoice(): AccuracyChoice | null {
    return this.#accuracy.choice;
  }

  /**
   * Measures now what the last frame shows, and chooses anew the settings that meet its wish: for all views with the same wish
   * and the same clouds, at the size of the largest.
   *
   * @throws InvalidArgumentError where there is no frame yet, or it was drawn without a wish; DestroyedError; an AbortError
   *   where the view is destroyed or a later call takes over; the signal's reason. Settings stay as they were then.
   */
  async chooseAccuracy(options: ChooseAccuracyOptions = {}): Promise<AccuracyChoice> {
    this.checkUsable();
    return this.#accuracy.choose(options);
  }

  /**
   * Returns the splat that contributes most to a pixel of the last frame, whatever another renderer draws in front of it; null
   * where there is none, outside of the image, and before the first frame.
   *
   * @param xPx, yPx from the top left of the image; fractions fall to the pixel that they are in.
   * @throws DestroyedError where the view or its engine end meanwhile.
   */
  async pick(xPx: number, yPx: number): Promise<SplatPick | null> {
    this.checkUsable();
    const { pipelines } = this.context;
    while (this.#prepared && !this.#isDestroyed) {
      const { request, layer, shape } = this.#prepared;
      const { widthPx, heightPx } = request;
      if (!(xPx >= 0 && xPx < widthPx && yPx >= 0 && yPx < heightPx)) return null;
      const stage = pick(shape.accuracy.recordPrecision);
      if (pipelines.areReady([stage])) {
        // The pixel of the layer behind the middle of the image's.
        const layerX = ((Math.floor(xPx) + 0.5) * layer.widthPx) / widthPx;
        const layerY = ((Math.floor(yPx) + 0.5) * layer.heightPx) / heightPx;
        return pickSplat(this.context, this.parts, this.#prepared, layerX, layerY);
      }
      // While this compiles another frame may be drawn, with other records, or the last one.
      await pipelines.prepare([stage]);
    }
    return null;
  }

  /**
   * All effects of the last frame, on and off, with the reason; none before the first frame. While shaders for other effects are
   * being compiled, that frame has the old ones.
   */
  effects(): readonly EffectEntry[] {
    if (!this.#prepared) return [];
    const { memory } = this.context;
    const { shared, preprocess, keptColors, resolveDepth, compose } = this.parts;
    const bytesOf = (each: readonly (GPUBuffer | GPUTexture | null | undefined)[]) =>
      [...new Set(each)].reduce((sum, resource) => sum + memory.bytesOf(resource), 0);
    const held = {
      selectionBytes: (cloudIndex: number) => preprocess.selectionBytes(cloudIndex),
      keptColorsBytes: keptColors.bytes,
      testedDepthBytes: bytesOf([shared.hostDepth]) + resolveDepth.bytes,
      writtenDepthBytes: bytesOf([
        shared.image?.depthLayer,
        shared.blended?.depthLayer,
        compose.image?.depth,
      ]),
    };
    return effectsLedger({ plan: this.#prepared, held });
  }

  /** @internal Draws the frames that follow without these effects, for measurements of what they cost. */
  omitEffects(effects: readonly OmittableEffect[]): void {
    this.#omittedEffects = effects;
  }

  /** @internal Number of the last frame among all that the engine has drawn; 0 before the first. */
  get drawnAs(): number {
    return this.#drawnAs;
  }

  /** @internal Shape of the last frame; null before the first. */
  get shape(): FrameShape | null {
    return this.parts.shape;
  }

  protected get isDestroyed(): boolean {
    return this.#isDestroyed;
  }

  /** Resolves when the last frame asked for has been submitted; rejects where its shaders do not compile. */
  protected get drawn(): Promise<void> {
    return this.#whenDrawn;
  }

  /** Whether a request waits for its shaders. */
  protected get isWaiting(): boolean {
    return this.#wait !== null;
  }

  protected canStillDraw({ clouds }: FrameRequest): boolean {
    const isUsable = !this.#isDestroyed && this.context.destroyedBecause() === null;
    return isUsable && clouds.every(({ cloud }) => !cloud.isDestroyed);
  }

  /** A choice of settings was made because of a wish; `request` is the last frame that stands. */
  protected abstract onChosen(choice: AccuracyChoice, request: FrameRequest): void;

  /** Shaders that `request`, the newest one, lacked have been compiled: it is to be drawn, or to wait on for others. */
  protected abstract retry(request: FrameRequest): void;

  /**
   * Checks a request.
   *
   * @returns whether it has pixels.
   * @throws InvalidArgumentError naming what cannot be drawn and why, DestroyedError for a destroyed cloud.
   */
  protected check(request: FrameRequest): boolean {
    checkRequest(request, this.context.device);
    if (request.widthPx > 0 && request.heightPx > 0) return true;
    // A plan would have found out.
    for (const instance of request.clouds) effectsOf(instance);
    return false;
  }

  /**
   * Plans a frame, and compiles the shaders that it lacks.
   *
   * @param depths how depth may hide splats: first as asked, then what else may be drawn while shaders for that are lacking.
   */
  protected next(
    request: FrameRequest,
    depths: readonly [RasterizeDepth | null, ...(RasterizeDepth | null)[]],
  ): NextFrame {
    const asked = this.#plan(request, this.#accuracy.settingsFor(request), depths[0]);
    if (!request.force && this.#isPrepared(asked)) {
      this.#endWait();
      return { plan: asked, stands: true, isAsked: true };
    }
    const plan = this.#keepingColors(asked);
    if (this.#isReady(plan.shape)) {
      this.#endWait();
      return { plan, stands: false, isAsked: true };
    }
    this.#waitFor(plan, request);
    const stopgap = this.#stopgapFor(plan, depths);
    return { plan: stopgap, stands: stopgap !== null && this.#isPrepared(stopgap), isAsked: false };
  }

  /**
   * Compiles the shaders of another shape than the one that is drawn, so that they are there when `reason` brings one.
   *
   * @param change makes it of the one that is drawn.
   */
  protected expect(
    reason: 'turning in place' | 'occluders',
    drawn: FrameShape,
    change: (drawn: FrameShape) => FrameShape,
  ): void {
    if (this.#expected.get(reason) === drawn) return;
    const shape = change(drawn);
    if (this.#isReady(shape)) this.#expected.set(reason, drawn);
    else this.context.pipelines.prepare(frameStages(shape)).catch(() => {});
  }

  /**
   * Makes room for a frame and writes its uniforms. Record it then.
   *
   * @throws InvalidArgumentError, GpuLimitError; the old frame stays then.
   */
  protected makeRoom(plan: FramePlan): void {
    const { widthPx, heightPx } = plan.request;
    checkSize(this.context.device, widthPx, heightPx);
    const isOrderKept = !plan.request.force && this.#prepared !== null && isSameOrder(this.#prepared, plan);
    const isReplaced = this.parts.fit(plan);
    this.#isColorsOnly = isOrderKept && !isReplaced;
    this.#prepared = plan;
  }

  protected recordOrder(encoder: GPUCommandEncoder): void {
    this.parts.recordOrder(encoder, this.timer, this.#isColorsOnly);
    this.context.counting.framesPrepared++;
  }

  protected recordDraw(encoder: GPUCommandEncoder, destination: Destination): void {
    this.parts.recordDraw(encoder, this.timer, destination);
    this.#drawnAs = ++this.context.counting.framesDrawn;
    this.timer.record(encoder, this.parts.shared.buffers);
  }

  /** Call when the frame of `request` stands, or already did. */
  protected shown(request: FrameRequest): void {
    this.#accuracy.show(request);
  }

  /** Call after submitting. */
  protected async measure(): Promise<void> {
    const totalSplats = this.shape?.clouds.reduce((sum, { cloud }) => sum + cloud.count, 0) ?? 0;
    const statistics = await this.timer.read(++this.#frameNumber, totalSplats);
    if (!statistics || this.#isDestroyed) return;
    this.#statistics = statistics;
    this.onStatistics?.(statistics);
  }

  /** Ends the view; `free` what it holds when nothing uses that any more. */
  protected end(): boolean {
    if (this.#isDestroyed) return false;
    this.#isDestroyed = true;
    this.#wait = null;
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

  #plan(request: FrameRequest, accuracy: AccuracySettings, depth: RasterizeDepth | null): FramePlan {
    return planFrame(request, {
      accuracy,
      depth,
      dispatchRow: this.context.dispatchRow,
      output: this.#output,
      omitted: this.#omittedEffects,
      last: this.#prepared,
    });
  }

  /** Whether the frame that `plan` would draw stands already. */
  #isPrepared(plan: FramePlan): boolean {
    const last = this.#prepared;
    return (
      last !== null &&
      isSameDepth(last.shape.depth, plan.shape.depth) &&
      isSameOrder(last, plan) &&
      isSameColors(last, plan)
    );
  }

  /** `plan` with the colours kept of clouds that are seen again from one place, once the shaders for that are there. */
  #keepingColors(plan: FramePlan): FramePlan {
    const { keptColors } = this.parts;
    const wanted = keptColors.wants(plan);
    if (wanted.includes(true)) {
      const keeping = withKeptColors(plan, wanted, this.#prepared);
      if (this.#isReady(keeping.shape) || !this.#isReady(plan.shape)) return keeping;
    }
    // What moves at all may come to turn in place.
    if (this.#prepared && !plan.request.force) {
      this.expect('turning in place', plan.shape, () => {
        const possible = plan.clouds.map((_, i) => canKeepColors(plan, i));
        return withKeptColors(plan, possible, this.#prepared).shape;
      });
    }
    return plan;
  }

  /**
   * The same frame with the settings and effects of the last one in place of those whose shaders are still compiling, so that
   * nothing stands still for that; null where there is none, or it would show other clouds.
   */
  #stopgapFor({ request, shape }: FramePlan, depths: readonly (RasterizeDepth | null)[]): FramePlan | null {
    const last = this.#prepared;
    if (!last || last.clouds.length !== request.clouds.length) return null;
    const { depth } = last.shape;
    if (!depths.some((possible) => isSameDepth(possible, depth))) return null;
    if (request.clouds.some(({ cloud }, i) => cloud !== last.shape.clouds[i].cloud)) return null;
    const clouds = request.clouds.map((instance, i) => {
      const { opacity, effects, shDegree } = last.clouds[i].instance;
      const drawn = last.shape.clouds[i].effects;
      if (shape.clouds[i].effects === drawn) return { ...instance, shDegree };
      // One may have been called for only since then, by what was selected.
      const before = effects?.filter(
        ({ effect, reason }) => reason === null || drawn.effects.includes(effect),
      );
      return { ...instance, shDegree, opacity, effects: before };
    });
    const plan = this.#plan({ ...request, clouds }, last.shape.accuracy, depth);
    const stopgap = this.#keepingColors(plan);
    return this.#isReady(stopgap.shape) ? stopgap : null;
  }

  #isReady(shape: FrameShape): boolean {
    if (this.#ready.has(shape)) return true;
    const isReady = this.context.pipelines.areReady(frameStages(shape));
    if (isReady) this.#ready.add(shape);
    return isReady;
  }

  /** Compiles the shaders of `plan`, unless a request waits already: the newest one takes its place then. */
  #waitFor(plan: FramePlan, request: FrameRequest): void {
    if (this.#wait) {
      this.#wait.request = request;
      return;
    }
    this.#wait = { request };
    this.#whenDrawn = this.#retryWhenCompiled(this.#wait, plan);
    // A shader that does not compile is an error of the device already; a caller who waits for no frame gets no second one.
    this.#whenDrawn.catch(() => {});
  }

  async #retryWhenCompiled(wait: Wait, { shape }: FramePlan): Promise<void> {
    try {
      await this.context.pipelines.prepare(frameStages(shape));
      if (this.#wait !== wait) return;
      this.#wait = null;
      if (this.canStillDraw(wait.request)) this.retry(wait.request);
    } finally {
      if (this.#wait === wait) this.#wait = null;
    }
    // By then the newest request may lack other shaders.
    if (this.#wait) await this.#whenDrawn;
  }

  #endWait(): void {
    this.#wait = null;
    this.#whenDrawn = Promise.resolve();
  }
}

/** A wait for shaders. */
interface Wait {
  /** The newest one. */
  request: FrameRequest;
}

function checkSize({ limits }: GPUDevice, widthPx: number, heightPx: number): void {
  const limit = limits.maxTextureDimension2D;
  if (Math.max(widthPx, heightPx) <= limit) return;
  const message = `An image of ${widthPx}×${heightPx} px is larger than this device's ${limit} px (maxTextureDimension2D).`;
  throw new InvalidArgumentError('widthPx', message);
}
