import { type AccuracySettings, isSoftwareAdapter } from '@websplatter/core';
import type { ViewerState, ViewerStore } from '../state/store.ts';
import type { Viewer } from '../viewer/viewer.ts';
import type { Measurement } from './measurement.ts';

/** A software rasteriser takes as long for a frame as a GPU for a hundred, and varies less. */
const SOFTWARE_FRAMES = 3;

/**
 * Measures what accuracy costs in the picture that stands. A wish is measured as soon as it is made, and again for each
 * scene that is opened.
 */
export class AccuracySweep {
  readonly #viewer: Viewer;
  readonly #store: ViewerStore;
  readonly #measurement: Measurement;
  /** What was drawn before there was this wish in this scene: comes back where nothing is chosen. */
  #fallback: AccuracySettings;

  constructor(viewer: Viewer, store: ViewerStore, measurement: Measurement) {
    this.#viewer = viewer;
    this.#store = store;
    this.#measurement = measurement;
    this.#fallback = store.getState().accuracy;
  }

  /** Begins the measurements that are wished for, and ends those of a wish that is no more; returns what stops that. */
  watch(): () => void {
    return this.#store.subscribe((state, before) => {
      const { wish, scene, sweep, sweepProblem } = state;
      if (wish !== before.wish || scene !== before.scene) this.#fallback = before.accuracy;
      if (wish !== before.wish && sweep?.of === 'accuracy') this.#measurement.stop();
      if (sweepProblem !== before.sweepProblem && sweepProblem?.of === 'accuracy') this.#giveUp();
      if (lacksChoice(this.#store.getState())) void this.choose();
    });
  }

  /** Measures the present view: presets, settings one at a time away from the default, and promising combinations. */
  async measure(): Promise<void> {
    const measured = await this.#measurement.run('accuracy', async ({ engine, frame }, options) => {
      const { measureAccuracy } = await import('@websplatter/core/measure');
      const { camera, clouds, widthPx, heightPx } = frame;
      const table = await measureAccuracy(engine, {
        clouds,
        cameras: [camera],
        widthPx,
        heightPx,
        ...(isSoftwareAdapter(engine.device.adapterInfo) && { frames: SOFTWARE_FRAMES, combinations: false }),
        ...options,
      });
      return { table };
    });
    if (measured) this.#store.setState({ measured });
  }

  /** Measures what meets the wish, and draws with it. */
  async choose(): Promise<void> {
    const measured = await this.#measurement.run('accuracy', async (_, options) => {
      const { table } = await this.#viewer.chooseAccuracy(options);
      return { table };
    });
    if (measured) this.#store.setState({ measured });
  }

  /** What was found before stays; a wish that nothing was chosen for yet ends. */
  cancel(): void {
    this.#measurement.stop();
    this.#giveUp();
  }

  #giveUp(): void {
    const { wish, choice } = this.#store.getState();
    if (wish && !choice) this.#viewer.setAccuracy(this.#fallback);
  }
}

/** Whether there is a picture and a wish, but nothing was chosen for it. */
function lacksChoice({ wish, choice, status, scene, isIdle }: ViewerState): boolean {
  return wish !== null && choice === null && status === 'running' && scene !== null && isIdle;
}
