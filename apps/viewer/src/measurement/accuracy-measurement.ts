import type { AccuracySettings } from '@websplatter/core';
import type { AccuracyTable } from '@websplatter/core/measure';
import type { MeasuredAccuracy } from '../state/measured.ts';
import type { ViewerStore } from '../state/store.ts';
import type { ViewerState } from '../state/viewer-state.ts';
import type { Viewer } from '../viewer/viewer.ts';
import type { Measurement } from './measurement.ts';

/**
 * Measures costs of accuracy for the frame on the screen. A target is measured as soon as it is
 * made, and again for each scene that is opened.
 */
export class AccuracyMeasurement {
  readonly #viewer: Viewer;
  readonly #store: ViewerStore;
  readonly #measurement: Measurement;
  /** Settings from before this target in this scene: they come back if nothing is chosen. */
  #fallback: AccuracySettings;

  constructor(viewer: Viewer, store: ViewerStore, measurement: Measurement) {
    this.#viewer = viewer;
    this.#store = store;
    this.#measurement = measurement;
    this.#fallback = store.getState().accuracy;
  }

  /** Starts a target's measurement and ends a former target's; returns a function to stop this. */
  watch(): () => void {
    return this.#store.subscribe((state, before) => {
      const { target, scene, measuring, failedMeasurement } = state;
      if (target !== before.target || scene !== before.scene) this.#fallback = before.accuracy;
      if (target !== before.target && measuring?.of === 'accuracy') this.#measurement.stop();
      if (failedMeasurement !== before.failedMeasurement && failedMeasurement?.of === 'accuracy')
        this.#giveUp();
      if (lacksChoice(this.#store.getState())) void this.choose();
    });
  }

  /**
   * Measures the present view: the presets; or also settings one at a time away from the default,
   * and promising combinations. Results so far stay if it is cancelled.
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

  /** Measures which settings meet the target, and draws with them. */
  async choose(): Promise<void> {
    const measured = await this.#measurement.run('accuracy', async (_, options) => {
      const { table } = await this.#viewer.chooseAccuracy(options);
      return { table, sweep: 'target' as const, isCutShort: false, allSettingsMs: null };
    });
    if (measured) this.#take(measured);
  }

  /** Results of a cancelled measurement replace none that tell more of the same image. */
  #take(measured: MeasuredAccuracy): void {
    const before = this.#store.getState().measured;
    const tellsLess =
      measured.isCutShort &&
      before?.imageId === measured.imageId &&
      before.table.points.length >= measured.table.points.length;
    if (!tellsLess) this.#store.setState({ measured });
  }

  /** An earlier choice stays; a target without one ends. */
  cancel(): void {
    this.#measurement.stop();
    this.#giveUp();
  }

  #giveUp(): void {
    const { target, choice } = this.#store.getState();
    if (target && !choice) this.#viewer.setAccuracy(this.#fallback);
  }
}

/** Whether there are an image at rest and a target, but nothing was chosen for it. */
function lacksChoice({ target, choice, status, scene, isIdle }: ViewerState): boolean {
  return target !== null && choice === null && status === 'running' && scene !== null && isIdle;
}
