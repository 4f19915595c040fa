import type { AccuracyWish } from '../accuracy/accuracy-wish.ts';
import type { SplatCloud } from '../clouds/splat-cloud.ts';
import { DestroyedError, InvalidArgumentError } from '../errors.ts';
import type { FrameRequest } from '../frame/frame-request.ts';
import type { AccuracyChoice } from '../measure/choose-accuracy.ts';
import type { MeasureProgress } from '../measure/measure-accuracy.ts';
import type { WishOptions } from '../measure/measure-wish.ts';
import { numberOf } from '../number-of.ts';

/** Until nothing has changed for as long as this, a scene is taken to be still in the making. */
const SETTLED_AFTER_MS = 500;

export interface ChooseAccuracyOptions {
  /** Calls the measurement off: what was drawn before stays. */
  readonly signal?: AbortSignal;
  readonly onProgress?: (progress: MeasureProgress) => void;
}

/** What a choice is told to. */
export interface WishingView {
  /** @param picture its last one. */
  onChosen(choice: AccuracyChoice, picture: FrameRequest): void;
}

interface WishContext {
  /** Chooses settings for what `picture` shows, and makes its clouds hold what they take. */
  readonly measure: (
    wish: AccuracyWish,
    picture: FrameRequest,
    options: WishOptions,
  ) => Promise<AccuracyChoice>;
  /** Makes the clouds hold what `choice` takes, as far as it can be had, and nothing that no view is drawn with; never rejects. */
  readonly adopt: (choice: AccuracyChoice, clouds: readonly SplatCloud[]) => Promise<void>;
}

/** The wishes of an engine's views, each met by measuring what is drawn: one measurement at a time. */
export class AccuracyWishes {
  readonly #context: WishContext;
  /** By wish and clouds. */
  readonly #scenes = new Map<string, WishedScene>();
  readonly #latest = new WeakMap<AccuracyWish, AccuracyChoice>();
  #lastTurn: Promise<unknown> = Promise.resolve();

  constructor(context: WishContext) {
    this.#context = context;
  }

  /** What was chosen last for `wish`, an interned one, whatever was drawn; null before the first choice. */
  latest(wish: AccuracyWish): AccuracyChoice | null {
    return this.#latest.get(wish) ?? null;
  }

  /** The scene that all views share that show these clouds with this wish, an interned one. */
  sceneOf(wish: AccuracyWish, { clouds }: FrameRequest, previous: AccuracyChoice | null): WishedScene {
    const distinct = new Set(clouds.map(({ cloud }) => cloud));
    const key = JSON.stringify([numberOf(wish), ...[...distinct].map(numberOf).sort((a, b) => a - b)]);
    let scene = this.#scenes.get(key);
    if (!scene) {
      const measure: WishContext['measure'] = (...request) => this.#inTurn(...request);
      const adopt: WishContext['adopt'] = (choice, clouds) => {
        this.#latest.set(wish, choice);
        return this.#context.adopt(choice, clouds);
      };
      const start = previous?.wish === wish ? previous : this.latest(wish);
      scene = new WishedScene(wish, distinct, start, { measure, adopt });
      this.#scenes.set(key, scene);
    }
    return scene;
  }

  /** Calls off what is measured for `wish`, an interned one, until a view shows again that it has it. */
  withdraw(wish: AccuracyWish): void {
    for (const scene of this.#scenes.values()) if (scene.wish === wish) scene.pause();
  }

  /** Ends what is measured: of the scenes with `cloud`, or of all. Who waits for a choice hears `reason`. */
  stop(reason: Error, cloud?: SplatCloud): void {
    for (const [key, scene] of this.#scenes) {
      if (cloud && !scene.clouds.has(cloud)) continue;
      this.#scenes.delete(key);
      scene.end(reason);
    }
  }

  async #inTurn(wish: AccuracyWish, picture: FrameRequest, options: WishOptions): Promise<AccuracyChoice> {
    const turn = this.#lastTurn.then(() => {
      options.signal.throwIfAborted();
      return this.#context.measure(wish, picture, options);
    });
    this.#lastTurn = turn.catch(() => {});
    return turn;
  }
}

/** A wish and the clouds that it is for: what is chosen for them is drawn by all views that show them. */
export class WishedScene {
  readonly wish: AccuracyWish;
  readonly clouds: ReadonlySet<SplatCloud>;
  readonly #context: WishContext;
  /** The views that show it, and the last picture of each. */
  readonly #views = new Map<WishingView, FrameRequest | null>();
  #choice: AccuracyChoice | null;
  /** Whether nothing is to be measured any more without being asked: it has been, or it cannot be. */
  #isSettled = false;
  #timer: ReturnType<typeof setTimeout> | undefined;
  #running: AbortController | null = null;

  /** @param previous drawn until there is a choice for these very clouds. */
  constructor(
    wish: AccuracyWish,
    clouds: ReadonlySet<SplatCloud>,
    previous: AccuracyChoice | null,
    context: WishContext,
  ) {
    this.wish = wish;
    this.clouds = clouds;
    this.#choice = previous;
    this.#context = context;
  }

  /** What is drawn, or null before the first choice. */
  get choice(): AccuracyChoice | null {
    return this.#choice;
  }

  join(view: WishingView): void {
    this.#views.set(view, null);
  }

  /** The last view to leave ends what is measured. */
  leave(view: WishingView): void {
    this.#views.delete(view);
    if (this.#views.size > 0) return;
    this.#running?.abort(new DOMException('No view shows what was measured any more.', 'AbortError'));
    this.#wait();
  }

  /** Takes note of a picture that stands; a while after the first, and after the last change of a size, it is measured. */
  show(view: WishingView, picture: FrameRequest): void {
    const before = this.#views.get(view);
    this.#views.set(view, picture);
    const isNew = before?.widthPx !== picture.widthPx || before.heightPx !== picture.heightPx;
    if (isNew && !this.#isSettled && !this.#running) this.#wait();
    if (!before && this.#isSettled && this.#choice) void this.#resume(view, this.#choice);
  }

  /**
   * Measures now and tells all views what was chosen. What is being measured already is called off.
   *
   * @throws InvalidArgumentError where there is no picture yet; the signal's reason; an AbortError where a later call takes
   *   over; what `measureAccuracy` throws. What was drawn before stays then.
   */
  async choose({ signal, onProgress }: ChooseAccuracyOptions = {}): Promise<AccuracyChoice> {
    const picture = this.#largestPicture();
    if (!picture) {
      const message = 'There is no picture yet to measure: draw some clouds first.';
      throw new InvalidArgumentError('chooseAccuracy', message);
    }
    clearTimeout(this.#timer);
    this.#running?.abort(new DOMException('A later measurement took the place of this one.', 'AbortError'));
    const ending = new AbortController();
    this.#running = ending;
    const signals = signal ? [ending.signal, signal] : [ending.signal];
    const options = { signal: AbortSignal.any(signals), onProgress, previous: this.#choice };
    try {
      const choice = await this.#context.measure(this.wish, picture, options);
      options.signal.throwIfAborted();
      this.#isSettled = true;
      this.#choice = choice;
      // Its planes are held since it was measured; the others go.
      void this.#context.adopt(choice, [...this.clouds]);
      for (const [view, shown] of this.#views) if (shown) view.onChosen(choice, shown);
      return choice;
    } finally {
      if (this.#running === ending) {
        this.#running = null;
        // Called off before there was any choice.
        if (!this.#isSettled) this.#wait();
      }
    }
  }

  /** Calls off what is measured, until a view shows its next picture. */
  pause(): void {
    for (const view of this.#views.keys()) this.#views.set(view, null);
    this.#running?.abort(new DOMException('The wish was withdrawn.', 'AbortError'));
    this.#wait();
  }

  /** Measures no more and lets go of its views. */
  end(reason: Error): void {
    this.#isSettled = true;
    this.#views.clear();
    clearTimeout(this.#timer);
    this.#running?.abort(reason);
  }

  /** Draws what was chosen earlier, for which the clouds may hold the planes no more. */
  async #resume(view: WishingView, choice: AccuracyChoice): Promise<void> {
    const { geometryPrecision, shPrecision } = choice.settings;
    const lacking = [...this.clouds].filter(({ precisions: { geometry, sh } }) => {
      return !(geometry.includes(geometryPrecision) && sh.includes(shPrecision));
    });
    await this.#context.adopt(choice, lacking);
    const picture = this.#views.get(view);
    if (picture && this.#choice === choice) view.onChosen(choice, picture);
  }

  #wait(): void {
    clearTimeout(this.#timer);
    if (this.#largestPicture()) this.#timer = setTimeout(() => void this.#chooseByItself(), SETTLED_AFTER_MS);
  }

  async #chooseByItself(): Promise<void> {
    try {
      await this.choose();
    } catch (error) {
      const { name, message } = error as Error;
      if (name === 'AbortError' || error instanceof DestroyedError) return;
      clearTimeout(this.#timer);
      this.#isSettled = true;
      console.warn(`The wish ${JSON.stringify(this.wish)} could not be measured; pictures stay. ${message}`);
    }
  }

  /** Of its last pictures, the one with most pixels. */
  #largestPicture(): FrameRequest | null {
    let largest: FrameRequest | null = null;
    for (const picture of this.#views.values()) {
      if (picture && pixelsOf(picture) > pixelsOf(largest)) largest = picture;
    }
    return largest;
  }
}

function pixelsOf(picture: FrameRequest | null): number {
  return picture ? picture.widthPx * picture.heightPx * Math.min(1, picture.clouds.length) : 0;
}
