import type { AccuracyTarget } from '../data/accuracy/accuracy-target.ts';
import { DestroyedError } from '../data/errors.ts';
import { type Detail, type FixedDetail, isSameDetail } from '../frame/plan/detail.ts';
import { drawnDetail, type FramePlan, showsClouds } from '../frame/plan/frame-plan.ts';
import type { FrameRequest } from '../frame/plan/frame-request.ts';
import { splatsInSight } from '../frame/plan/level-cut.ts';
import type { FrameStatistics } from '../gpu/timing/frame-statistics.ts';
import { FramePace, type MovingFrame } from './frame-pace.ts';
import { type CutFinders, PsnrPromise } from './psnr-promise.ts';

/** Detail of a view's last frame. */
export interface DetailReport {
  readonly asked: Detail;
  /** The detail of the frame: `asked`, or the detail found for it. */
  readonly drawn: FixedDetail;
  /**
   * Factor of the width and height that splats are blended at, besides `resolutionScale` of the
   * frame's accuracy: 1, or a half while something moves, if pixels take too long for a target in
   * milliseconds.
   */
  readonly movingScale: number;
  /**
   * Prediction from cuts of these clouds that were compared last, dB; null if none were or none is
   * needed.
   */
  readonly predictedPsnrDb: number | null;
  /** PSNR of this very frame against the full image by `reference`, dB; null if not measured. */
  readonly measuredPsnrDb: number | null;
  /**
   * Count of parts of streamed scenes that the frame needs but that are not on the GPU, as far as
   * is known.
   */
  readonly missing: number;
  /** Whether the image stays as it is unless something moves. */
  readonly isComplete: boolean;
}

/** The services of a view for finding detail. */
export interface DetailContext {
  /** Returns the target of `accuracy`; null if it has settings instead. Default: the engine's. */
  readonly targetFor: (accuracy: FrameRequest['accuracy']) => AccuracyTarget | null;
  readonly cutFinders: CutFinders;
  /** Returns a request with the settings of the last frame instead of a target. */
  readonly asDrawn: (request: FrameRequest) => FrameRequest;
  /** Resolves when the GPU has done the work that was submitted before. */
  readonly whenDone: () => Promise<unknown>;
  /** Draws the frame of a request again with the detail found for it. */
  readonly drawAgain: (request: FrameRequest) => void;
  /** Compiles the shaders for such frames, and makes the levels that they need. */
  readonly precompile: (request: FrameRequest, moving: MovingFrame) => void;
}

/** An image is at rest if nothing has moved for this long since it was drawn, ms. */
export const RESTS_AFTER_MS = 250;
/** Moving images are predicted anew after this long, ms, … */
const PREDICTED_EVERY_MS = 250;
/** … and after this many times as long as the last prediction took: it draws cuts to compare. */
const PREDICTED_EVERY_TIMES = 8;
const WHOLE: MovingFrame = { detail: 'full', movingScale: 1 };
/** The target of `auto`: 60 Hz, with reserve for the page's own work. */
const AUTO: AccuracyTarget = { maxFrameMs: 12 };

/**
 * Finds the detail of frames that request an outcome; distinguishes images at rest from moving
 * ones.
 */
export class ViewDetail {
  readonly #context: DetailContext;
  #target: AccuracyTarget | null = null;
  /**
   * `#pace` for a target in milliseconds, `#promise` for one in decibels; both null without a
   * target.
   */
  #pace: FramePace | null = null;
  #promise: PsnrPromise | null = null;
  /** How the last planned frame is drawn. */
  #planned: MovingFrame = WHOLE;
  #isAtRest = true;
  /** Whether something has moved since the last drawn frame. */
  #hasMoved = false;
  /** Counts frames in which something has moved. */
  #moves = 0;
  #timer: ReturnType<typeof setTimeout> | undefined;
  #measuring = new AbortController();
  /** Ends the prediction in flight; null if there is none. */
  #predicting: AbortController | null = null;
  /** When the next prediction may begin. */
  #predictsFromMs = 0;
  /** Pending until the image at rest is complete; null if it is. */
  #completion: { readonly complete: Promise<void>; readonly end: () => void } | null = null;

  constructor(context: DetailContext) {
    this.#context = context;
  }

  /** Resolves when the image at rest has the requested detail; null if it has. */
  get complete(): Promise<void> | null {
    return this.#completion?.complete ?? null;
  }

  /**
   * Plans the frame of a request. If nothing moves, it keeps the detail of the last frame until the
   * detail at rest is known.
   *
   * @param last the last frame; null before the first.
   * @param planWith plans the frame to be drawn in this way; undefined for the request's own.
   */
  plan(
    request: FrameRequest,
    last: FramePlan | null,
    planWith: (moving: MovingFrame | undefined) => FramePlan,
  ): FramePlan {
    const isNew = this.#take(request);
    if (!this.#target) return planWith(undefined);
    const again = planWith(this.#planned);
    if (isNew || !again.isDrawn) {
      // The first image of a scene counts as at rest, because its time and PSNR are unknown.
      this.#isAtRest = isNew || !last || !showsClouds(last, request.clouds);
      this.#promise?.move(again, this.#isAtRest);
      this.#stop('Something moves.');
      if (this.#isAtRest) this.#predicting?.abort();
      this.#hasMoved = true;
    }
    const wanted = again.isDrawn && !this.#isAtRest ? this.#planned : this.#wanted;
    if (this.#isPlanned(wanted)) return again;
    this.#planned = wanted;
    return planWith(wanted);
  }

  /** Call when the frame of `request` has been submitted, or is drawn already. */
  onDrawn(request: FrameRequest): void {
    if (!this.#hasMoved) return;
    this.#hasMoved = false;
    void this.#waitForRest(request);
    if (this.#promise && !this.#isAtRest) void this.#predict(request, this.#promise);
    if (this.#completion) return;
    let end = () => {};
    const complete = new Promise<void>((resolve) => {
      end = resolve;
    });
    this.#completion = { complete, end };
  }

  /** Updates the budget by the time of a frame. */
  addFrame(plan: FramePlan, { visibleSplats, timing }: FrameStatistics): void {
    if (!this.#pace) return;
    const { clouds, detail, movingScale, request } = plan;
    const inSight = splatsInSight(clouds);
    this.#pace.addFrame({ drawn: drawnDetail(plan), movingScale, inSight, visibleSplats, timing });
    const { moving } = this.#pace;
    // The levels are made early, so that the first moving frame need not wait for them.
    const needsLevels = detail === 'full' && moving.detail !== 'full';
    if (needsLevels || moving.movingScale < movingScale) this.#context.precompile(request, moving);
  }

  /** The report's fields about finding detail. `plan` may precede the current state. */
  report({
    detail,
    request,
  }: FramePlan): Pick<DetailReport, 'predictedPsnrDb' | 'measuredPsnrDb' | 'isComplete'> {
    return {
      predictedPsnrDb: this.#promise?.predictedPsnrDb(detail) ?? null,
      measuredPsnrDb: this.#promise?.measuredPsnrDb ?? null,
      isComplete: !this.#completion && !this.#hasMoved && isSameDetail(this.#targetOf(request), this.#target),
    };
  }

  /** Call when the view is destroyed. */
  end(): void {
    this.#stop('The picture is no longer shown.');
    this.#predicting?.abort();
    this.#completion?.end();
    this.#completion = null;
  }

  get #wanted(): MovingFrame {
    if (this.#isAtRest) return this.#promise ? { ...WHOLE, detail: this.#promise.still } : WHOLE;
    return this.#pace ? this.#pace.moving : { ...WHOLE, detail: this.#promise!.moving };
  }

  #isPlanned({ detail, movingScale }: MovingFrame): boolean {
    return movingScale === this.#planned.movingScale && isSameDetail(detail, this.#planned.detail);
  }

  /** Returns whether the target has changed. */
  #take(request: FrameRequest): boolean {
    const target = this.#targetOf(request);
    if (isSameDetail(target, this.#target)) return false;
    this.end();
    this.#target = target;
    this.#planned = WHOLE;
    this.#pace = target && 'maxFrameMs' in target ? new FramePace(target.maxFrameMs) : null;
    this.#promise =
      target && 'minPsnrDb' in target ? new PsnrPromise(target.minPsnrDb, this.#context.cutFinders) : null;
    return true;
  }

  /** Null if the request fixes the detail. */
  #targetOf({ detail = 'full', accuracy }: FrameRequest): AccuracyTarget | null {
    if (detail === 'auto') return this.#autoFor(accuracy);
    const { minPsnrDb, maxFrameMs } = Object(detail) as { minPsnrDb?: number; maxFrameMs?: number };
    if (minPsnrDb !== undefined) return { minPsnrDb };
    return maxFrameMs === undefined ? null : { maxFrameMs };
  }

  #autoFor(accuracy: FrameRequest['accuracy']): AccuracyTarget {
    const target = this.#context.targetFor(accuracy);
    return target && 'maxFrameMs' in target ? target : AUTO;
  }

  /** Aborts the timer and the measurement for an image at rest. */
  #stop(because: string): void {
    clearTimeout(this.#timer);
    this.#moves++;
    this.#measuring.abort(new DOMException(because, 'AbortError'));
    this.#hasMoved = false;
  }

  /**
   * Counts from the end of the frame: on devices that take longer for it than `RESTS_AFTER_MS`, a frame
   * at rest, slower still, would come between any two that move.
   */
  async #waitForRest(request: FrameRequest): Promise<void> {
    const moves = this.#moves;
    // A host submits the frame before it yields to microtasks.
    await null;
    await this.#context.whenDone();
    if (moves === this.#moves) this.#timer = setTimeout(() => void this.#rest(request), RESTS_AFTER_MS);
  }

  async #rest(request: FrameRequest): Promise<void> {
    this.#isAtRest = true;
    this.#predicting?.abort();
    this.#measuring = new AbortController();
    const { signal } = this.#measuring;
    if (!this.#isPlanned(this.#wanted)) this.#context.drawAgain(request);
    try {
      await this.#promise?.rest(this.#context.asDrawn(request), signal);
    } catch (error) {
      if (!signal.aborted && !(error instanceof DestroyedError))
        console.warn(`A picture could not be measured, and is drawn in full. ${(error as Error).message}`);
    }
    this.#predictsFromMs = performance.now() + PREDICTED_EVERY_MS;
    if (signal.aborted) return;
    if (!this.#isPlanned(this.#wanted)) this.#context.drawAgain(request);
    this.#completion?.end();
    this.#completion = null;
  }

  /** Predicts the frames after a moving one, unless one was predicted just now. */
  async #predict(request: FrameRequest, promise: PsnrPromise): Promise<void> {
    if (this.#predicting || performance.now() < this.#predictsFromMs) return;
    this.#predicting = new AbortController();
    const { signal } = this.#predicting;
    const beganMs = performance.now();
    try {
      await promise.predict(this.#context.asDrawn(request), signal);
    } catch (error) {
      if (!signal.aborted && !(error instanceof DestroyedError))
        console.warn(`Moving pictures could not be predicted. ${(error as Error).message}`);
    }
    this.#predicting = null;
    const endedMs = performance.now();
    this.#predictsFromMs =
      endedMs + Math.max(PREDICTED_EVERY_MS, PREDICTED_EVERY_TIMES * (endedMs - beganMs));
  }
}
