import { type Accuracy, type AccuracySettings, DEFAULT_ACCURACY } from '../accuracy/accuracy.ts';
import type { AccuracyRequest, AccuracyWish } from '../accuracy/accuracy-wish.ts';
import { InvalidArgumentError } from '../errors.ts';
import type { FrameRequest } from '../frame/frame-request.ts';
import type { AccuracyChoice } from '../measure/choose-accuracy.ts';
import type { AccuracyWishes, ChooseAccuracyOptions, WishedScene, WishingView } from './accuracy-wishes.ts';

/** What the settings of a frame follow from. */
export interface AccuracyContext {
  /** The wish of a frame that asks for this, or for nothing: one object for equal wishes, null for settings. */
  readonly wishFor: (asked: AccuracyRequest | undefined) => AccuracyWish | null;
  /** What the device can do of settings, default the engine's: one object for equal settings. */
  readonly accuracyFor: (asked: Accuracy | undefined) => AccuracySettings;
  readonly wishes: AccuracyWishes;
}

/** What a view draws with: what its frames ask for, or what was chosen because of their wish. */
export class ViewAccuracy implements WishingView {
  readonly #context: AccuracyContext;
  readonly #onChosen: (choice: AccuracyChoice, picture: FrameRequest) => void;
  #scene: WishedScene | null = null;
  #told: AccuracyChoice | null = null;

  /** @param onChosen called with each new choice and the picture to be drawn again with it, once whoever chose is done. */
  constructor(context: AccuracyContext, onChosen: (choice: AccuracyChoice, picture: FrameRequest) => void) {
    this.#context = context;
    this.#onChosen = onChosen;
  }

  get choice(): AccuracyChoice | null {
    return this.#scene?.choice ?? null;
  }

  /**
   * The settings of a frame that is about to be drawn.
   *
   * @throws InvalidArgumentError for unknown settings and for what is no wish.
   */
  settingsFor(frame: FrameRequest): AccuracySettings {
    const { wishFor, accuracyFor, wishes } = this.#context;
    const wish = wishFor(frame.accuracy);
    if (!wish) {
      this.leave();
      // With the engine's wish gone, `undefined` are its settings.
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

  /** Call when the picture of `frame` stands, or already did. */
  show(frame: FrameRequest): void {
    this.#scene?.show(this, frame);
  }

  /** See `SplatView.chooseAccuracy`. */
  async choose(options: ChooseAccuracyOptions): Promise<AccuracyChoice> {
    if (this.#scene) return this.#scene.choose(options);
    const message =
      'The last picture was drawn without a wish: give the frame or the engine one, and draw first.';
    throw new InvalidArgumentError('chooseAccuracy', message);
  }

  onChosen(choice: AccuracyChoice, picture: FrameRequest): void {
    // What listeners throw is theirs, and no reason to tell other views nothing.
    queueMicrotask(() => {
      if (this.choice !== choice || this.#told === choice) return;
      this.#told = choice;
      this.#onChosen(choice, picture);
    });
  }

  /** Call when the view is destroyed. */
  leave(): void {
    this.#scene?.leave(this);
    this.#scene = null;
  }
}
