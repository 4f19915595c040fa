import type { RecoveryPace } from '@websplatter/core';
import type { FirstPicture } from './first-picture.ts';

/** State of the renderer of a `<SplatCanvas>`. */
interface CanvasState {
  /** `<Splats>` call `recovered` once they have been drawn. */
  readonly pace: RecoveryPace;
  /** `<Splats>` count their loads and drawn clouds here. */
  readonly picture: FirstPicture;
  /**
   * The engine's accuracy as JSON. Setting an equal one again would make the engine claim planes for
   * clouds that have an accuracy of their own.
   */
  accuracyKey: string;
}

/** States by renderer. */
export const canvasStates = new WeakMap<object, CanvasState>();
