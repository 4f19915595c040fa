import { type AccuracySettings, isSoftwareAdapter } from '@websplatter/core';
import type { ViewerStore } from '../state/store.ts';
import type { ViewerState } from '../state/viewer-state.ts';
import type { Viewer } from '../viewer/viewer.ts';
import type { Measurement } from './measurement.ts';

/** A software rasteriser takes as long for a frame as a GPU for a hundred, and varies less. */
const SOFTWARE_FRAMES = 3;

/**
 * Measures what accuracy costs for the frame on the screen. A wish is measured as soon as it is made, and again for each
 * scene that is opened.
 */
export class AccuracyMeasurement {
  readonly #viewer: Viewer;
  readonly #store: ViewerStore;
  readonly #measurement: Measurement;
  /** Settings from before this wish in this scene: they come back if nothing is chosen. */
  #fallback: AccuracySettings;

  constructor(viewer: Viewer, store: ViewerStore, measurement: Measurement) {
    this.#viewer = viewer;
    this.#store = store;
    this.#measurement = measurement;
    this.#fallback = store.getState().accuracy;
  }

  /** Starts the measurement that a wish needs, and ends that of a wish that is no more; returns what stops that. */
  watch(): () => void {
    return this.#store.subscribe((state, before) => {
      const { wish, scene, measuring, failedMeasurement } = state;
      if (wish !== before.wish || scene !== before.scene) this.#fallback = before.accuracy;
      if (wish !== before.wish && measuring?.of === 'accuracy') this.#measurement.stop();
      if (failedMeasurement !== before.failedMeasurement && failedMeasurement?.of === 'accuracy')
        this.#giveUp();
      if (lacksChoice(this.#store.getState())) void this.choose();
    });
  }

  /** Measures the present view: presets, settings one at a time away from the default, and promising combinations. */
  async measure(): Promise<void> {
    const measured = await this.#measurement.run('accuracy', async ({ engine, frame }, options) => {
      const { measureAccuracy } = await import('@websplatter/core/measure');
      const { camera, clouds, widthPx, heightPx, sortBy } = frame;
      const table = await measureAccuracy(engine, {
        clouds,
        cameras: [camera],
        widthPx,
        heightPx,
        sortBy,
        ...(isSoftwareAdapter(engine.device.adapterInfo) && { frames: SOFTWARE_FRAMES, combinations: false }),
        ...options,
      });
      return { table };
    });
    if (measured) this.#store.setState({ measured });
  }

  /** Measures which settings meet the wish, and draws with them. */
  async choose(): Promise<void> {
    const measured = await this.#measurement.run('accuracy', async (_, options) => {
      const { table } = await this.#viewer.chooseAccuracy(options);
      return { table };
    });
    if (measured) this.#store.setState({ measured });
  }

  /** An earlier choice stays; a wish without one ends. */
  cancel(): void {
    this.#measurement.stop();
    this.#giveUp();
  }

  #giveUp(): void {
    const { wish, choice } = this.#store.getState();
    if (wish && !choice) this.#viewer.setAccuracy(this.#fallback);
  }
}

/** Whether there are an image at rest and a wish, but nothing was chosen for it. */
function lacksChoice({ wish, choice, status, scene, isIdle }: ViewerState): boolean {
  return wish !== null && choice === null && status === 'running' && scene !== null && isIdle;
}
