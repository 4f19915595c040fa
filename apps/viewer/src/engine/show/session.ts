import type { AccuracyChoice, SplatEngine, SplatView } from '@websplatter/core';
import type { Comparison } from '../../state/accuracy.ts';

/** The device and its objects; replaced as a whole when the device is lost. */
export interface Session {
  readonly canvas: HTMLCanvasElement;
  readonly engine: SplatEngine;
  readonly views: Views;
}

/** The views of a session. They end with its engine. */
export class Views {
  /** Draws to the viewer's canvas. */
  readonly main: SplatView;
  readonly #engine: SplatEngine;
  readonly #onAccuracyChosen: (choice: AccuracyChoice) => void;
  #right: SplatView | null = null;
  #probe: SplatView | null = null;

  constructor(
    engine: SplatEngine,
    canvas: HTMLCanvasElement,
    onAccuracyChosen: (choice: AccuracyChoice) => void,
  ) {
    this.#engine = engine;
    this.#onAccuracyChosen = onAccuracyChosen;
    this.main = this.#create(canvas);
  }

  /** Draws the right side of a split image; null if the image is not split. */
  get right(): SplatView | null {
    return this.#right;
  }

  /** Draws images to be read back. */
  get probe(): SplatView {
    this.#probe ??= this.#create();
    return this.#probe;
  }

  createRight(canvas: HTMLCanvasElement): SplatView {
    this.#right ??= this.#create(canvas);
    return this.#right;
  }

  destroyRight(): void {
    this.#right?.destroy();
    this.#right = null;
  }

  /** The view that draws the chosen settings or target, not the compared ones. */
  targeting(comparison: Comparison | null): SplatView {
    if (comparison?.kind !== 'split' || comparison.left === 'current') return this.main;
    return comparison.right === 'current' && this.#right ? this.#right : this.probe;
  }

  /**
   * Resolves when all frames requested before this call are complete on the GPU, with their detail
   * at rest. Rejects if their shaders do not compile.
   */
  async whenComplete(): Promise<void> {
    await Promise.all([this.main.whenComplete(), this.#right?.whenComplete()]);
    await this.#engine.device.queue.onSubmittedWorkDone();
  }

  #create(canvas?: HTMLCanvasElement): SplatView {
    const view = this.#engine.createView({ canvas });
    view.onAccuracyChosen = this.#onAccuracyChosen;
    return view;
  }
}
