import type { RecoveryPace } from '@websplatter/core';
import type { Vector3 } from 'three';

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
  /** Of all Canvases in succession. */
  readonly view: CanvasView;
  /** Whether a recovery has brought back a fitted camera, and the splats are not all back yet. */
  isViewKept: boolean;
}

/** What a succession of Canvases has shown. */
export interface CanvasView {
  /** Whether a `<SplatBounds>` has placed the camera: it is the visitor's from then on. */
  isFitted: boolean;
  /** Where the camera was when the last device was lost, and the controls that it had; null before. */
  left: LeftView | null;
}

export interface LeftView {
  readonly position: Vector3;
  readonly controls: object | null;
}

/** States by renderer. */
export const canvasStates = new WeakMap<object, CanvasState>();

/** Tells, once, when a Canvas shows its splats: one cloud is drawn whole, and none is being read. */
export class FirstPicture {
  #tell: (() => void) | null;
  #readings = 0;
  #isDrawn = false;

  constructor(onShown: () => void) {
    this.#tell = onShown;
  }

  /** A cloud is being read, until the returned function is called. */
  read(): () => void {
    this.#readings++;
    return () => {
      this.#readings--;
      this.#tellIfShown();
    };
  }

  /** A cloud has been drawn with all that its view needs. */
  drawn(): void {
    this.#isDrawn = true;
    this.#tellIfShown();
  }

  /** The Canvas is about to be replaced: its clouds leave, which shows nothing. */
  end(): void {
    this.#tell = null;
  }

  #tellIfShown(): void {
    if (!this.#isDrawn || this.#readings > 0) return;
    const tell = this.#tell;
    this.end();
    tell?.();
  }
}
