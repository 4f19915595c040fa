import { type Accuracy, type AccuracySettings, DEFAULT_ACCURACY } from '../accuracy/accuracy.ts';
import type { AccuracyRequest, AccuracyWish } from '../accuracy/accuracy-wish.ts';
import { InvalidArgumentError } from '../errors.ts';
import type { FrameRequest } from '../frame/frame-request.ts';
import type { AccuracyChoice } from '../measure/choose-accuracy.ts';
import type { AccuracyWishes, ChooseAccuracyOptions, WishedScene, WishingView } from './accuracy-wishes.ts';

/** The engine's part in the settings of a frame. */
export interface AccuracyContext {
  /** Returns the wish in `asked` (default: the engine's), or null for settings. Equal wishes are the same object. */
  readonly wishFor: (asked: AccuracyRequest | undefined) => AccuracyWish | null;
  /** Returns the closest settings that the device supports (default: the engine's). Equal settings are the same object. */
  readonly accuracyFor: (asked: Accuracy | undefined) => AccuracySettings;
  readonly wishes: AccuracyWishes;
}

/** The settings that a view draws with: the requested ones, or those chosen for a wish. */
export class ViewAccuracy implements WishingView {
  readonly #context: AccuracyContext;
  readonly #onChosen: (choice: AccuracyChoice, request: FrameRequest) => void;
  #scene: WishedScene | null = null;
  #reported: AccuracyChoice | null = null;

  /** @param onChosen called with each new choice and the request to draw again with it, in a microtask of its own. */
  constructor(context: AccuracyContext, onChosen: (choice: AccuracyChoice, request: FrameRequest) => void) {
    this.#context = context;
    this.#onChosen = onChosen;
  }

  get choice(): AccuracyChoice | null {
    return this.#scene?.choice ?? null;
  }

  /**
   * Returns the settings of a frame that is about to be drawn.
   *
   * @throws InvalidArgumentError for unknown settings and invalid wishes.
   */
  settingsFor(frame: FrameRequest): AccuracySettings {
    const { wishFor, accuracyFor, wishes } = this.#context;
    const wish = wishFor(frame.accuracy);
    if (!wish) {
      this.leave();
      // Without a wish of the engine, `undefined` stands for its settings.
      return accuracyFor(frame.accuracy as Accuracy | undefined);
    }
    const scene = wishes.sceneOf(wish, frame, this.choice);
    if (scene !== this.#scene) {
      this.leave();
      this.#scene = scene;
      scene.join(this);
    }
    return accuracyFor(scene.choice?.settings ?? DEFAULT_ACCURACY);
  }

  /** Call when `frame` has been drawn, or was shown already. */
  show(frame: FrameRequest): void {
    this.#scene?.show(this, frame);
  }

  /** See `SplatView.chooseAccuracy`. */
  async choose(options: ChooseAccuracyOptions): Promise<AccuracyChoice> {
    if (this.#scene) return this.#scene.choose(options);
    const message =
      'The last frame was drawn without a wish: give the frame or the engine one, and draw first.';
    throw new InvalidArgumentError('chooseAccuracy', message);
  }

  onChosen(choice: AccuracyChoice, request: FrameRequest): void {
    // An error in one listener must not keep the other views from being notified.
    queueMicrotask(() => {
      if (this.choice !== choice || this.#reported === choice) return;
      this.#reported = choice;
      this.#onChosen(choice, request);
    });
  }

  /** Call when the view is destroyed. */
  leave(): void {
    this.#scene?.leave(this);
    this.#scene = null;
  }
}
