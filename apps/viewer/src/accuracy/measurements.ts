import { type AccuracySettings, isSoftwareAdapter, WebSplatterError } from '@websplatter/core';
import type { AccuracyTable, MeasureProgress } from '@websplatter/core/measure';
import { shallow } from 'zustand/vanilla/shallow';
import type { ShownFrame, Viewer } from '../engine/viewer.ts';
import { PRESET_NAMES } from '../state/accuracy.ts';
import type { MeasuredAccuracy, MeasuredImage, MeasuredThing } from '../state/measured.ts';
import type { ViewerState, ViewerStore } from '../state/store.ts';
import { describeMeasured } from '../ui/accuracy-words.ts';

/** Five presets: 15 timed frames each, a first one for every three, one to compare and one to look at. */
const FRAMES_OF_PRESETS = 110;
/** Without a GPU three frames of each are timed. */
const SOFTWARE_FRAMES_OF_PRESETS = 30;

export interface Measurements {
  readonly measurement: Measurement;
  readonly accuracyMeasurement: AccuracyMeasurement;
  readonly stop: () => void;
}

/** Creates the measurements of the viewer's panels and for targets. They run until stopped. */
export function startMeasurements(viewer: Viewer, store: ViewerStore): Measurements {
  const measurement = new Measurement(viewer, store);
  const accuracyMeasurement = new AccuracyMeasurement(viewer, store, measurement);
  const stops = [measurement.watch(), accuracyMeasurement.watch()];
  const stop = () => {
    for (const each of stops) each();
  };
  return { measurement, accuracyMeasurement, stop };
}

/**
 * Measures costs of accuracy for the current frame. A target is measured as soon as it is set, and
 * again for each opened scene.
 */
export class AccuracyMeasurement {
  readonly #viewer: Viewer;
  readonly #store: ViewerStore;
  readonly #measurement: Measurement;
  /** Settings before the target applied to this scene; restored if none is chosen. */
  #fallback: AccuracySettings;

  constructor(viewer: Viewer, store: ViewerStore, measurement: Measurement) {
    this.#viewer = viewer;
    this.#store = store;
    this.#measurement = measurement;
    this.#fallback = store.getState().accuracy;
  }

  /** Number of frames that measuring the presets draws, about. */
  get framesOfPresets(): number {
    return this.#measurement.isOnSoftware ? SOFTWARE_FRAMES_OF_PRESETS : FRAMES_OF_PRESETS;
  }

  /**
   * Starts measuring for targets and cancels when a target ends; returns a function that stops
   * this.
   */
  watch(): () => void {
    const chooseIfNeeded = () => {
      if (lacksChoice(this.#store.getState())) void this.choose();
    };
    // The picture may already be at rest.
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
   * Measures the current view: the presets, or also single settings changed from the default and
   * promising combinations. Results are kept as they arrive, even if the measurement is cancelled.
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

  /** Draws the presets again for display, unless their pictures exist. */
  async #judge({ image: { imageId }, signal, onProgress }: MeasurementOptions): Promise<void> {
    const store = this.#store;
    const total = PRESET_NAMES.length;
    if (Object.keys(store.getState().judged ?? {}).length === total) return;
    store.setState({ judged: {} });
    const others = PRESET_NAMES.filter((name) => name !== 'reference');
    const report = (done: number) => onProgress({ done, total, label: 'Drawing the presets to look at' });
    report(0);
    const { judgePresets } = await import('./measure-sweep.ts');
    await judgePresets(this.#viewer, others, signal, (name, picture) => {
      const { judged, isIdle, imageId: newestId } = store.getState();
      // The view has changed meanwhile.
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

  /** Stores results, unless fuller results exist for the same image. */
  #take(measured: MeasuredAccuracy): void {
    const before = this.#store.getState().measured;
    const more = before ? measured.table.points.length - before.table.points.length : 0;
    const tellsLess =
      measured.isCutShort &&
      before?.imageId === measured.imageId &&
      (before.isCutShort ? more < 0 : more <= 0);
    if (!tellsLess) this.#store.setState({ measured });
  }

  /** Cancels the search for settings. An earlier choice stays; a target without a choice ends. */
  cancel(): void {
    this.#measurement.stop();
    this.#giveUp();
  }

  #giveUp(): void {
    const { target, choice } = this.#store.getState();
    if (target && !choice) this.#viewer.setAccuracy(this.#fallback);
  }
}

/** Whether there are a scene and a target for which no settings have been chosen. */
function lacksChoice({ target, choice, status, scene }: ViewerState): boolean {
  return target !== null && choice === null && status === 'running' && scene !== null;
}

interface MeasurementOptions {
  readonly image: MeasuredImage;
  readonly signal: AbortSignal;
  readonly onProgress: (progress: MeasureProgress) => void;
}

/**
 * Runs measurements of the current frame and writes their progress to the store. One at a time: two
 * would slow each other down.
 */
export class Measurement {
  readonly #viewer: Viewer;
  readonly #store: ViewerStore;
  #running: AbortController | null = null;

  constructor(viewer: Viewer, store: ViewerStore) {
    this.#viewer = viewer;
    this.#store = store;
  }

  /** Whether the current frame was drawn by a CPU; false if there is none. */
  get isOnSoftware(): boolean {
    const shown = this.#viewer.shownFrame;
    return shown !== null && isSoftwareAdapter(shown.engine.device.adapterInfo);
  }

  /** Cancels a measurement when its scene or device is gone. Returns a function that stops both. */
  watch(): () => void {
    const unsubscribe = this.#store.subscribe(
      ({ scene, status }) => [scene, status],
      () => this.stop(),
      { equalityFn: shallow },
    );
    return () => {
      unsubscribe();
      this.stop();
    };
  }

  /**
   * Runs `work` on the frame at rest; does nothing if there is none or another measurement runs.
   * Failures are written to the store.
   */
  async run(
    of: MeasuredThing,
    work: (shown: ShownFrame, options: MeasurementOptions) => Promise<void>,
  ): Promise<void> {
    if (!this.#viewer.shownFrame || this.#running) return;
    const store = this.#store;
    const running = new AbortController();
    this.#running = running;
    const { signal } = running;
    store.setState({ measuring: { of, done: 0, total: 1, label: 'Preparing' }, failedMeasurement: null });
    try {
      await this.#rest(signal);
      const shown = this.#viewer.shownFrame;
      if (!shown) return;
      const { imageId } = store.getState();
      const isSoftware = this.isOnSoftware;
      const onProgress = (progress: MeasureProgress) => {
        if (!signal.aborted) store.setState({ measuring: { of, ...progress, label: plainLabel(progress) } });
      };
      await work(shown, { image: { imageId, isSoftware }, signal, onProgress });
    } catch (error) {
      // The engine cancels measurements for views that have drawn something else.
      if (signal.aborted || (error as Error).name === 'AbortError') return;
      if (!(error instanceof WebSplatterError)) console.error(error);
      const text = error instanceof Error ? error.message : String(error);
      store.setState({ failedMeasurement: { of, text } });
    } finally {
      if (this.#running === running) {
        this.#running = null;
        store.setState({ measuring: null });
      }
    }
  }

  /** Resolves when the picture is at rest: results for an earlier one would be out of date. */
  #rest(signal: AbortSignal): Promise<void> {
    return new Promise((resolve, reject) => {
      const look = () => {
        if (!this.#viewer.isAtRest) return;
        unsubscribe();
        resolve();
      };
      const unsubscribe = this.#store.subscribe(look);
      signal.addEventListener('abort', () => {
        unsubscribe();
        reject(signal.reason);
      });
      look();
    });
  }

  /** Cancels the running measurement. */
  stop(): void {
    this.#running?.abort();
    this.#running = null;
    if (this.#store.getState().measuring) this.#store.setState({ measuring: null });
  }
}

/** The label of a step, with settings in plain words. */
function plainLabel({ label, point }: MeasureProgress): string {
  return point ? label.replace(point.name, describeMeasured(point)) : label;
}
