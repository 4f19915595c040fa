import {
  type Accuracy,
  type AccuracySettings,
  DEFAULT_ACCURACY,
  internAccuracy,
  type PossibleAccuracy,
} from '../data/accuracy/accuracy.ts';
import type { AccuracyRequest, AccuracyTarget } from '../data/accuracy/accuracy-target.ts';
import { InvalidArgumentError } from '../data/errors.ts';
import type { FrameRequest } from '../frame/plan/frame-request.ts';
import type { AccuracyChoice } from '../measure/choose-accuracy.ts';
import type { AccuracyTargets, ChooseAccuracyOptions, TargetScene, TargetView } from './accuracy-targets.ts';

/** The services of an engine for the settings of frames. */
export interface AccuracyContext {
  /**
   * Returns the target of `asked`, interned; null if it has settings instead. Default: the
   * engine's.
   */
  readonly targetFor: (asked: AccuracyRequest | undefined) => AccuracyTarget | null;
  /** Returns `possibleOn` the engine's device, of the settings `asked`. Default: the engine's. */
  readonly accuracyFor: (asked: Accuracy | undefined) => AccuracySettings;
  readonly targets: AccuracyTargets;
}

/** The settings of a view's frames: the requested ones, or the ones chosen for a target. */
export class ViewAccuracy implements TargetView {
  readonly #context: AccuracyContext;
  readonly #onChosen: (choice: AccuracyChoice, request: FrameRequest) => void;
  #scene: TargetScene | null = null;
  #reported: AccuracyChoice | null = null;

  /** @param onChosen called in a microtask with each new choice and the request to draw again. */
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
   * @throws InvalidArgumentError for unknown settings and invalid targets.
   */
  settingsFor(frame: FrameRequest): AccuracySettings {
    const { targetFor, accuracyFor, targets } = this.#context;
    const target = targetFor(frame.accuracy);
    if (!target) {
      this.leave();
      // `undefined` means the engine's settings, which have no target here.
      return accuracyFor(frame.accuracy as Accuracy | undefined);
    }
    const scene = targets.sceneOf(target, frame, this.choice);
    if (scene !== this.#scene) {
      this.leave();
      this.#scene = scene;
      scene.join(this);
    }
    return accuracyFor(scene.choice?.settings ?? DEFAULT_ACCURACY);
  }

  /** Call when `frame` has been submitted, or is drawn already. */
  onDrawn(frame: FrameRequest): void {
    this.#scene?.onDrawn(this, frame);
  }

  /** See `SplatView.chooseAccuracy`. */
  async choose(options: ChooseAccuracyOptions): Promise<AccuracyChoice> {
    if (this.#scene) return this.#scene.choose(options);
    const message =
      'The last frame was drawn without a target: give the frame or the engine one, and draw first.';
    throw new InvalidArgumentError('chooseAccuracy', message);
  }

  onChosen(choice: AccuracyChoice, request: FrameRequest): void {
    // Deferred until all views of the scene have the choice.
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

/** Returns the closest settings that the device supports, interned as `requested` are. */
export function possibleOn(device: GPUDevice, requested: AccuracySettings): PossibleAccuracy {
  if (
    requested.colorTarget === 'rgba32float' &&
    !device.features.has('float32-blendable' as GPUFeatureName)
  ) {
    const notice =
      'This device cannot blend rgba32float; frames are blended in rgba16float. Where the GPU can, ' +
      "adapter.requestDevice({ requiredFeatures: ['float32-blendable'] }) makes one that does.";
    return { settings: internAccuracy({ ...requested, colorTarget: 'rgba16float' }), notices: [notice] };
  }
  return { settings: requested, notices: [] };
}
