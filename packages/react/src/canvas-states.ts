import type { RecoveryPace } from '@websplatter/core';

/** State of the renderer of a `<SplatCanvas>`. */
interface CanvasState {
  /** Told by `<Splats>` when they have been drawn. */
  readonly pace: RecoveryPace;
  /**
   * The engine's accuracy as JSON. Setting the same one again would make the engine claim it for
   * clouds that have an accuracy of their own.
   */
  accuracyKey: string;
}

/** By renderer. */
export const canvasStates = new WeakMap<object, CanvasState>();
