import type { RecoveryPace } from '@websplatter/core';
import type { FirstPicture } from './first-picture.ts';

/** State of the renderer of a `<SplatCanvas>`. */
interface CanvasState {
  /** Told by `<Splats>` when they have been drawn. */
  readonly pace: RecoveryPace;
  /** Told by `<Splats>` what they read and have drawn. */
  readonly picture: FirstPicture;
  /**
   * The engine's accuracy as JSON. Setting the same one again would make the engine claim it for
   * clouds that have an accuracy of their own.
   */
  accuracyKey: string;
}

/** By renderer. */
export const canvasStates = new WeakMap<object, CanvasState>();
