import type { AccuracySettings } from '@websplatter/core';
import type { AccuracyTable } from '@websplatter/core/measure';
import type { MeasuredAccuracy } from '../state/measured.ts';
import type { ViewerStore } from '../state/store.ts';
import type { ViewerState } from '../state/viewer-state.ts';
import type { Viewer } from '../viewer/viewer.ts';
import type { Measurement } from './measurement.ts';

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

  /**
   * Measures the present view: the presets; or also settings one at a time away from the default, and promising combinations.
   * What was measured stays if it is called off.
   */
  async measure(sweep: 'presets' | 'settings'): Promise<void> {
    let timed: AccuracyTable | null = null;
    const measured = await this.#measurement.run(
      'accuracy',
      async (drawn, options) => {
        const { measureSweep } = await import('./measure-sweep.ts');
        const onTable = (table: AccuracyTable) => {
          timed = table;
        };
        const measured = await measureSweep(drawn, sweep, { ...options, onTable });
        return { ...measured, sweep, isCutShort: false };
      },
      () => timed && { table: timed, sweep, isCutShort: true, allSettingsMs: null },
    );
    if (measured) this.#take(measured);
  }

  /** Measures which settings meet the wish, and draws with them. */
  async choose(): Promise<void> {
    const measured = await this.#measurement.run('accuracy', async (_, options) => {
      const { table } = await this.#viewer.chooseAccuracy(options);
      return { table, sweep: 'wish' as const, isCutShort: false, allSettingsMs: null };
    });
    if (measured) this.#take(measured);
  }

  /** What was called off replaces nothing that tells more of the same image. */
  #take(measured: MeasuredAccuracy): void {
    const before = this.#store.getState().measured;
    const tellsLess =
      measured.isCutShort &&
      before?.imageId === measured.imageId &&
      before.table.points.length >= measured.table.points.length;
    if (!tellsLess) this.#store.setState({ measured });
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
