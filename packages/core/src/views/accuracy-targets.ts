import { isHeld } from '../clouds/cloud-planes.ts';
import type { SplatCloud } from '../clouds/splat-cloud.ts';
import type { AccuracyTarget } from '../data/accuracy/accuracy-target.ts';
import { DestroyedError, InvalidArgumentError } from '../data/errors.ts';
import { numberOf } from '../data/number-of.ts';
import type { FrameRequest } from '../frame/plan/frame-request.ts';
import type { AccuracyChoice } from '../measure/choose-accuracy.ts';
import type { MeasureProgress } from '../measure/measure-accuracy.ts';
import type { TargetOptions } from '../measure/measure-target.ts';

/** A scene counts as loading until it has not changed for this long. */
const SETTLED_AFTER_MS = 500;

/** Options of `view.chooseAccuracy`. */
export interface ChooseAccuracyOptions {
  /** Aborts the measurement; the settings stay. */
  readonly signal?: AbortSignal;
  readonly onProgress?: (progress: MeasureProgress) => void;
}

/** A view that receives choices. */
export interface TargetView {
  /** @param request the view's last request. */
  onChosen(choice: AccuracyChoice, request: FrameRequest): void;
}

interface TargetContext {
  /** Chooses settings for the frame of `request`, and makes its clouds hold the planes for them. */
  readonly measure: (
    target: AccuracyTarget,
    request: FrameRequest,
    options: TargetOptions,
  ) => Promise<AccuracyChoice>;
  /**
   * Makes clouds hold the planes for `choice`, if possible, and frees unused planes; never rejects.
   */
  readonly adopt: (choice: AccuracyChoice, clouds: readonly SplatCloud[]) => Promise<void>;
}

/** Meets the accuracy targets of an engine's views by measuring their frames, one at a time. */
export class AccuracyTargets {
  readonly #context: TargetContext;
  /** Keyed by target and clouds. */
  readonly #scenes = new Map<string, TargetScene>();
  readonly #latest = new WeakMap<AccuracyTarget, AccuracyChoice>();
  #lastTurn: Promise<unknown> = Promise.resolve();

  constructor(context: TargetContext) {
    this.#context = context;
  }

  /** Returns the last choice for `target` (interned), for any clouds; null before the first. */
  latest(target: AccuracyTarget): AccuracyChoice | null {
    return this.#latest.get(target) ?? null;
  }

  /** Returns the scene shared by all views that draw these clouds with this target (interned). */
  sceneOf(target: AccuracyTarget, { clouds }: FrameRequest, previous: AccuracyChoice | null): TargetScene {
    const distinct = new Set(clouds.map(({ cloud }) => cloud));
    const key = JSON.stringify([numberOf(target), ...[...distinct].map(numberOf).sort((a, b) => a - b)]);
    let scene = this.#scenes.get(key);
    if (!scene) {
      const measure: TargetContext['measure'] = (...args) => this.#inTurn(...args);
      const adopt: TargetContext['adopt'] = (choice, clouds) => {
        this.#latest.set(target, choice);
        return this.#context.adopt(choice, clouds);
      };
      const start = previous?.target === target ? previous : this.latest(target);
      scene = new TargetScene(target, distinct, start, { measure, adopt });
      this.#scenes.set(key, scene);
    }
    return scene;
  }

  /** Aborts the measurements for `target` (interned) until a view draws a frame with it again. */
  withdraw(target: AccuracyTarget): void {
    for (const scene of this.#scenes.values()) if (scene.target === target) scene.pause();
  }

  /** Stops measuring scenes with `cloud`, or all scenes. Pending choices reject with `reason`. */
  stop(reason: Error, cloud?: SplatCloud): void {
    for (const [key, scene] of this.#scenes) {
      if (cloud && !scene.clouds.has(cloud)) continue;
      this.#scenes.delete(key);
      scene.end(reason);
    }
  }

  async #inTurn(
    target: AccuracyTarget,
    request: FrameRequest,
    options: TargetOptions,
  ): Promise<AccuracyChoice> {
    const turn = this.#lastTurn.then(() => {
      options.signal.throwIfAborted();
      return this.#context.measure(target, request, options);
    });
    // The caller gets the error; the next one takes its turn all the same.
    this.#lastTurn = turn.catch(() => {});
    return turn;
  }
}

/** A target and its clouds. All views that draw the clouds with this target share one choice. */
export class TargetScene {
  readonly target: AccuracyTarget;
  readonly clouds: ReadonlySet<SplatCloud>;
  readonly #context: TargetContext;
  /** The views of the scene, with their last requests. */
  readonly #views = new Map<TargetView, FrameRequest | null>();
  #choice: AccuracyChoice | null;
  /** Whether automatic measuring is over: the scene was measured, or cannot be. */
  #isSettled = false;
  #timer: ReturnType<typeof setTimeout> | undefined;
  #running: AbortController | null = null;

  /** @param previous the choice to draw with until these clouds have been measured. */
  constructor(
    target: AccuracyTarget,
    clouds: ReadonlySet<SplatCloud>,
    previous: AccuracyChoice | null,
    context: TargetContext,
  ) {
    this.target = target;
    this.clouds = clouds;
    this.#choice = previous;
    this.#context = context;
    // The loaded cloud will soon replace a preview.
    this.#isSettled = [...clouds].some(({ isPreview }) => isPreview);
  }

  /** The choice to draw with, or null before the first. */
  get choice(): AccuracyChoice | null {
    return this.#choice;
  }

  join(view: TargetView): void {
    this.#views.set(view, null);
  }

  /** Removes a view. The last view to leave ends the measurement. */
  leave(view: TargetView): void {
    this.#views.delete(view);
    if (this.#views.size === 0)
      this.#running?.abort(new DOMException('No view shows what was measured any more.', 'AbortError'));
    // The remaining views may still wait for shaders; their first frame schedules measuring again.
    if (!this.#largestRequest()) clearTimeout(this.#timer);
  }

  /**
   * Records a drawn frame. Schedules measuring after a view's first frame and after changes of
   * size.
   */
  onDrawn(view: TargetView, request: FrameRequest): void {
    const before = this.#views.get(view);
    this.#views.set(view, request);
    const isNew = before?.widthPx !== request.widthPx || before.heightPx !== request.heightPx;
    if (isNew && !this.#isSettled && !this.#running) this.#wait();
    if (!before && this.#isSettled && this.#choice) void this.#resume(view, this.#choice);
  }

  /**
   * Measures now and passes the choice to all views. Aborts a running measurement.
   *
   * @throws InvalidArgumentError if there is no frame yet; the signal's reason; an AbortError if a
   *   later call takes over; errors of `measureAccuracy`. On failure the settings stay.
   */
  async choose({ signal, onProgress }: ChooseAccuracyOptions = {}): Promise<AccuracyChoice> {
    const request = this.#largestRequest();
    if (!request) {
      const message = 'There is no image yet to measure: draw some clouds first.';
      throw new InvalidArgumentError('chooseAccuracy', message);
    }
    clearTimeout(this.#timer);
    this.#running?.abort(new DOMException('A later measurement took the place of this one.', 'AbortError'));
    const ending = new AbortController();
    this.#running = ending;
    const signals = signal ? [ending.signal, signal] : [ending.signal];
    const options = { signal: AbortSignal.any(signals), onProgress, previous: this.#choice };
    try {
      const choice = await this.#context.measure(this.target, request, options);
      options.signal.throwIfAborted();
      this.#isSettled = true;
      this.#choice = choice;
      // The measurement made the clouds hold the planes of the choice; this frees other planes.
      void this.#context.adopt(choice, [...this.clouds]);
      for (const [view, shown] of this.#views) if (shown) view.onChosen(choice, shown);
      return choice;
    } catch (error) {
      // The abort reason takes precedence over errors that follow from it.
      options.signal.throwIfAborted();
      throw error;
    } finally {
      if (this.#running === ending) {
        this.#running = null;
        // The measurement was aborted before any choice.
        if (!this.#isSettled) this.#wait();
      }
    }
  }

  /** Aborts the measurement until a view draws its next frame. */
  pause(): void {
    for (const view of this.#views.keys()) this.#views.set(view, null);
    this.#running?.abort(new DOMException('The target was withdrawn.', 'AbortError'));
    this.#wait();
  }

  /** Ends measuring for good and releases the views. */
  end(reason: Error): void {
    this.#isSettled = true;
    this.#views.clear();
    clearTimeout(this.#timer);
    this.#running?.abort(reason);
  }

  /** Passes an earlier choice to a new view; the clouds may no longer hold its planes. */
  async #resume(view: TargetView, choice: AccuracyChoice): Promise<void> {
    const lacking = [...this.clouds].filter(({ precisions }) => !isHeld(precisions, choice.settings));
    await this.#context.adopt(choice, lacking);
    const request = this.#views.get(view);
    if (request && this.#choice === choice) view.onChosen(choice, request);
  }

  #wait(): void {
    clearTimeout(this.#timer);
    if (this.#largestRequest()) this.#timer = setTimeout(() => void this.#chooseByItself(), SETTLED_AFTER_MS);
  }

  async #chooseByItself(): Promise<void> {
    try {
      await this.choose();
    } catch (error) {
      const { name, message } = error as Error;
      if (name === 'AbortError' || error instanceof DestroyedError) return;
      clearTimeout(this.#timer);
      this.#isSettled = true;
      console.warn(
        `The target ${JSON.stringify(this.target)} could not be measured; images stay. ${message}`,
      );
    }
  }

  /** Returns the views' last request with the most pixels. */
  #largestRequest(): FrameRequest | null {
    let largest: FrameRequest | null = null;
    for (const request of this.#views.values()) {
      if (request && pixelsOf(request) > pixelsOf(largest)) largest = request;
    }
    return largest;
  }
}

function pixelsOf(request: FrameRequest | null): number {
  return request ? request.widthPx * request.heightPx * Math.min(1, request.clouds.length) : 0;
}
