import type { AccuracySettings } from '@websplatter/core';
import type { AccuracyTable } from '@websplatter/core/measure';
import type { Viewer } from '../engine/viewer.ts';
import type { MeasuredAccuracy } from '../state/measured.ts';
import { PRESET_NAMES } from '../state/nearest-preset.ts';
import type { ViewerState, ViewerStore } from '../state/store.ts';
import type { Measurement, MeasurementOptions } from './measurement.ts';

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
    const chooseIfNeeded = () => {
      if (lacksChoice(this.#store.getState())) void this.choose();
    };
    // The picture may have come to rest before.
    chooseIfNeeded();
    return this.#store.subscribe((state, before) => {
      const { target, scene, measuring, failedMeasurement } = state;
      // Whole pictures take a lot of memory.
      if (state.imageId !== before.imageId) this.#store.setState({ judged: null });
      if (target !== before.target || scene !== before.scene) this.#fallback = before.accuracy;
      if (target !== before.target && measuring?.of === 'accuracy') this.#measurement.stop();
      if (failedMeasurement !== before.failedMeasurement && failedMeasurement?.of === 'accuracy')
        this.#giveUp();
      chooseIfNeeded();
    });
  }

  /**
   * Measures the present view: the presets; or also settings one at a time away from the default,
   * and promising combinations. Results are kept as they come, also if it is cancelled.
   */
  async measure(sweep: 'presets' | 'settings'): Promise<void> {
    await this.#measurement.run('accuracy', async (drawn, { image, ...options }) => {
      const { measureSweep } = await import('./measure-sweep.ts');
      const take = (result: Pick<MeasuredAccuracy, 'table' | 'allSettingsMs'>, isCutShort: boolean) => {
        if (!options.signal.aborted) this.#take({ ...image, ...result, sweep, isCutShort });
      };
      const onTable = (table: AccuracyTable) => take({ table, allSettingsMs: null }, true);
      take(await measureSweep(drawn, sweep, { ...options, onTable }), false);
      await this.#judge({ image, ...options });
    });
  }

  /** Draws the presets once more for people to look at, unless their pictures are there. */
  async #judge({ image: { imageId }, signal, onProgress }: MeasurementOptions): Promise<void> {
    const store = this.#store;
    const total = PRESET_NAMES.length;
    if (Object.keys(store.getState().judged ?? {}).length === total) return;
    store.setState({ judged: {} });
    const others = PRESET_NAMES.filter((name) => name !== 'reference');
    const report = (done: number) => onProgress({ done, total, label: 'Drawing the presets to look at' });
    report(0);
    const { judgePresets } = await import('./judge-presets.ts');
    await judgePresets(this.#viewer, others, signal, (name, picture) => {
      const { judged, isIdle, imageId: newestId } = store.getState();
      // The camera has moved on.
      if (newestId !== imageId || !isIdle || !judged) return this.#measurement.stop();
      store.setState({ judged: { ...judged, [name]: picture } });
      report(Object.keys(judged).length + 1);
    });
  }

  /** Measures which settings meet the target, and draws with them. */
  async choose(): Promise<void> {
    await this.#measurement.run('accuracy', async (_, { image, ...options }) => {
      const { table } = await this.#viewer.chooseAccuracy(options);
      this.#take({ ...image, table, sweep: 'target', isCutShort: false, allSettingsMs: null });
    });
  }

  /** Results so far replace none that tell more of the same image. */
  #take(measured: MeasuredAccuracy): void {
    const before = this.#store.getState().measured;
    const more = before ? measured.table.points.length - before.table.points.length : 0;
    const tellsLess =
      measured.isCutShort &&
      before?.imageId === measured.imageId &&
      (before.isCutShort ? more < 0 : more <= 0);
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
