import type { AccuracyTarget } from '../data/accuracy/accuracy-target.ts';
import { DestroyedError } from '../data/errors.ts';
import { type Detail, type FixedDetail, isSameDetail } from '../frame/detail.ts';
import { drawnDetail, type FramePlan, showsClouds } from '../frame/frame-plan.ts';
import type { FrameRequest } from '../frame/frame-request.ts';
import { splatsInSight } from '../frame/level-cut.ts';
import type { StageTimings } from '../gpu/timing/frame-statistics.ts';
import { FramePace } from './frame-pace.ts';
import { type MeasureDetail, PsnrPromise } from './psnr-promise.ts';

/** Detail of a view's last frame. */
export interface DetailReport {
  readonly asked: Detail;
  /** What the frame was drawn with: `asked`, or what was found for it. */
  readonly drawn: FixedDetail;
  /** Predicted by cuts of these clouds that were measured before; null where none were, or need be. */
  readonly predictedPsnrDb: number | null;
  /** Measured, against the full picture by `reference`, for this very frame; null if it was not. */
  readonly measuredPsnrDb: number | null;
  /** Parts of streaming scenes that the frame would show if they were on the GPU, as far as is known. */
  readonly missing: number;
  /** Whether the picture stays like this unless something moves. */
  readonly isComplete: boolean;
}

/** The view's part in finding detail. */
export interface DetailContext {
  /** Returns the target of `accuracy` (default the engine's); null for settings. */
  readonly targetFor: (accuracy: FrameRequest['accuracy']) => AccuracyTarget | null;
  readonly measure: MeasureDetail;
  /** Draws the frame of a request again, whose detail has been found. */
  readonly redraw: (request: FrameRequest) => void;
  /** Compiles the shaders of a frame with this detail, and makes the levels that it needs. */
  readonly foresee: (request: FrameRequest, detail: FixedDetail) => void;
}

/** A picture is at rest when nothing has moved for this long. */
export const RESTS_AFTER_MS = 250;
/** Time of `auto`: at 60 Hz, with room for a page's own work. */
const AUTO: AccuracyTarget = { maxFrameMs: 12 };

/** Finds the detail of frames that ask for an outcome, and tells pictures at rest from moving ones. */
export class ViewDetail {
  readonly #context: DetailContext;
  #target: AccuracyTarget | null = null;
  /** Of a target, one of these. */
  #pace: FramePace | null = null;
  #promise: PsnrPromise | null = null;
  /** Of the last frame that was planned. */
  #planned: FixedDetail = 'full';
  #isAtRest = true;
  /** Whether something has moved since a frame was shown. */
  #hasMoved = false;
  #timer: ReturnType<typeof setTimeout> | undefined;
  #measuring = new AbortController();
  /** Settles when the picture is complete; null if it is. */
  #wait: { readonly complete: Promise<void>; readonly end: () => void } | null = null;

  constructor(context: DetailContext) {
    this.#context = context;
  }

  /** Resolves when the picture at rest has the detail that was asked for; null if it has. */
  get complete(): Promise<void> | null {
    return this.#wait?.complete ?? null;
  }

  /**
   * Plans the frame of a request. Where nothing moves it has the detail of the last one, until that
   * of the picture at rest is known.
   *
   * @param last the last frame; null before the first.
   * @param planWith plans the frame with a detail; undefined: with the request's own.
   */
  plan(
    request: FrameRequest,
    last: FramePlan | null,
    planWith: (detail: FixedDetail | undefined) => FramePlan,
  ): FramePlan {
    const isNew = this.#take(request);
    if (!this.#target) return planWith(undefined);
    const again = planWith(this.#planned);
    if (isNew || !again.stands) {
      // The first picture of a scene is one at rest: nothing is known of its time or decibels.
      this.#isAtRest = isNew || !last || !showsClouds(last, request.clouds);
      this.#promise?.move(again, this.#isAtRest);
      this.#stop('Something moves.');
      this.#hasMoved = true;
    }
    const detail = again.stands && !this.#isAtRest ? this.#planned : this.#wanted;
    if (isSameDetail(detail, this.#planned)) return again;
    this.#planned = detail;
    return planWith(detail);
  }

  /** Call when the frame of `request` has been drawn, or was shown already. */
  show(request: FrameRequest): void {
    if (!this.#hasMoved) return;
    this.#hasMoved = false;
    this.#timer = setTimeout(() => void this.#rest(request), RESTS_AFTER_MS);
    if (this.#wait) return;
    let end = () => {};
    const complete = new Promise<void>((resolve) => {
      end = resolve;
    });
    this.#wait = { complete, end };
  }

  /** Takes the time of a frame. */
  learn(plan: FramePlan, timing: StageTimings): void {
    if (!this.#pace) return;
    const { clouds, detail, request } = plan;
    this.#pace.learn({ drawn: drawnDetail(plan), inSight: splatsInSight(clouds), timing });
    const { moving } = this.#pace;
    // The first frame that moves need not wait for levels then.
    if (detail === 'full' && moving !== 'full') this.#context.foresee(request, moving);
  }

  /** The part of the report on a frame that is known here; it may have been planned before this was. */
  report({
    detail,
    request,
  }: FramePlan): Pick<DetailReport, 'predictedPsnrDb' | 'measuredPsnrDb' | 'isComplete'> {
    return {
      predictedPsnrDb: this.#promise?.predictedPsnrDb(detail) ?? null,
      measuredPsnrDb: this.#promise?.measuredPsnrDb ?? null,
      isComplete: !this.#wait && !this.#hasMoved && isSameDetail(this.#targetOf(request), this.#target),
    };
  }

  /** Call when the view is destroyed. */
  end(): void {
    this.#stop('The picture is no longer shown.');
    this.#wait?.end();
    this.#wait = null;
  }

  get #wanted(): FixedDetail {
    if (!this.#isAtRest) return (this.#pace ?? this.#promise)!.moving;
    return this.#promise?.still ?? 'full';
  }

  /** Returns whether another target is asked for than before. */
  #take(request: FrameRequest): boolean {
    const target = this.#targetOf(request);
    if (isSameDetail(target, this.#target)) return false;
    this.end();
    this.#target = target;
    this.#planned = 'full';
    this.#pace = target && 'maxFrameMs' in target ? new FramePace(target.maxFrameMs) : null;
    this.#promise =
      target && 'minPsnrDb' in target ? new PsnrPromise(target.minPsnrDb, this.#context.measure) : null;
    return true;
  }

  /** Null where nothing is to be found. */
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

  /** Ends what waits for a picture at rest. */
  #stop(because: string): void {
    clearTimeout(this.#timer);
    this.#measuring.abort(new DOMException(because, 'AbortError'));
    this.#hasMoved = false;
  }

  async #rest(request: FrameRequest): Promise<void> {
    this.#isAtRest = true;
    this.#measuring = new AbortController();
    const { signal } = this.#measuring;
    if (!isSameDetail(this.#wanted, this.#planned)) this.#context.redraw(request);
    try {
      await this.#promise?.rest(request, signal);
    } catch (error) {
      if (!signal.aborted && !(error instanceof DestroyedError))
        console.warn(`A picture could not be measured, and is drawn in full. ${(error as Error).message}`);
    }
    if (signal.aborted) return;
    if (!isSameDetail(this.#wanted, this.#planned)) this.#context.redraw(request);
    this.#wait?.end();
    this.#wait = null;
  }
}
