import {
  ACCURACY_PRESETS,
  type AccuracyPreset,
  type AccuracySettings,
  type SplatCloud,
} from '@websplatter/core';
import type { AccuracyTable, MeasureAccuracyOptions } from '@websplatter/core/measure';
import { Remote } from '@websplatter/core/write';
import { workerFailure } from '@websplatter/kit/worker-failure';
import { allClouds } from '../engine/open/shown-scene.ts';
import type { ImageOnBackground, ShownFrame, Viewer } from '../engine/viewer.ts';
import { PRESET_NAMES } from '../state/accuracy.ts';
import type { JudgedPicture, MeasuredAccuracy } from '../state/measured.ts';
import type { ViewerState, ViewerStore } from '../state/store.ts';
import type { ErrorMapTasks } from './error-map.worker.ts';
import { RestMeasurement, type RestMeasurementOptions } from './measure-at-rest.ts';

/**
 * What a sweep tries. Software draws few frames: one takes it as long as a hundred take a GPU, and their
 * times vary less. Combinations of settings take many frames to find.
 */
const SWEEPS = {
  presets: {
    gpu: { settings: [], ablations: false, combinations: false, frames: 15 },
    software: { settings: [], ablations: false, combinations: false, frames: 3 },
  },
  settings: { gpu: { combinations: true, frames: 15 }, software: { combinations: false, frames: 3 } },
} as const;

export interface Measurements {
  readonly measurement: RestMeasurement;
  readonly accuracyMeasurement: AccuracyMeasurement;
  readonly stop: () => void;
}

/** Creates the measurements of the viewer's panels and for targets. They run until stopped. */
export function startMeasurements(viewer: Viewer, store: ViewerStore): Measurements {
  const measurement = new RestMeasurement(viewer, store);
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
  readonly #measurement: RestMeasurement;
  /** Settings before the target applied to this scene; restored if none is chosen. */
  #fallback: AccuracySettings;

  constructor(viewer: Viewer, store: ViewerStore, measurement: RestMeasurement) {
    this.#viewer = viewer;
    this.#store = store;
    this.#measurement = measurement;
    this.#fallback = store.getState().accuracy;
  }

  /** Number of frames that measuring the presets draws, about. */
  get framesOfPresets(): number {
    const { frames } = SWEEPS.presets[this.#measurement.isOnSoftware ? 'software' : 'gpu'];
    // Besides timed frames: one before every three, one to compare and one to look at.
    return PRESET_NAMES.length * (frames + Math.ceil(frames / 3) + 2);
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
  async measure(sweep: keyof typeof SWEEPS): Promise<void> {
    await this.#measurement.run('accuracy', async (drawn, { image, ...options }) => {
      const take = (result: Pick<MeasuredAccuracy, 'table' | 'allSettingsMs'>, isCutShort: boolean) => {
        if (!options.signal.aborted) this.#take({ ...image, ...result, sweep, isCutShort });
      };
      const onTable = (table: AccuracyTable) => take({ table, allSettingsMs: null }, true);
      const adapter = image.isSoftware ? 'software' : 'gpu';
      take(await measureSweep(drawn, sweep, adapter, { ...options, onTable }), false);
      await this.#judge({ image, ...options });
    });
  }

  /** Draws the presets again for display, unless their pictures exist. */
  async #judge({ image: { imageId }, signal, onProgress }: RestMeasurementOptions): Promise<void> {
    const store = this.#store;
    const total = PRESET_NAMES.length;
    if (Object.keys(store.getState().judged ?? {}).length === total) return;
    store.setState({ judged: {} });
    const others = PRESET_NAMES.filter((name) => name !== 'reference');
    const report = (done: number) => onProgress({ done, total, label: 'Drawing the presets to look at' });
    report(0);
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

/**
 * Measures the costs of presets, or of all settings, for a frame.
 *
 * @returns the table; for presets also the estimated time for all settings, ms.
 */
async function measureSweep(
  { engine, frame }: ShownFrame,
  sweep: keyof typeof SWEEPS,
  adapter: 'gpu' | 'software',
  options: Pick<MeasureAccuracyOptions, 'signal' | 'onProgress' | 'onTable'>,
): Promise<Pick<MeasuredAccuracy, 'table' | 'allSettingsMs'>> {
  const { countMeasureSteps, measureAccuracy } = await import('@websplatter/core/measure');
  const { camera, clouds, widthPx, heightPx, sortBy, detail } = frame;
  const image = { clouds, cameras: [camera], widthPx, heightPx, sortBy, detail };
  const asked = { ...image, ...SWEEPS[sweep][adapter] };
  const table = await measureAccuracy(engine, { ...asked, ...options });
  if (sweep === 'settings') return { table, allSettingsMs: null };
  const all = countMeasureSteps({ ...image, ...SWEEPS.settings[adapter] });
  return { table, allSettingsMs: (table.elapsedMs * all) / countMeasureSteps(asked) };
}

/**
 * Draws the current frame with each preset to a texture, and compares it with `reference`, which
 * comes first.
 */
async function judgePresets(
  viewer: Viewer,
  others: readonly AccuracyPreset[],
  signal: AbortSignal,
  onPicture: (name: AccuracyPreset, picture: JudgedPicture) => void,
): Promise<void> {
  const remote = new Remote<ErrorMapTasks>(
    () => new Worker(new URL('./error-map.worker.ts', import.meta.url), { type: 'module' }),
    { failure: workerFailure },
  );
  try {
    for (const name of ['reference', ...others] as const) {
      const scene = viewer.scenes.newest;
      if (!scene) return;
      const image = await readWith(viewer, allClouds(scene), name, signal);
      if (!image || signal.aborted) return;
      const buffer = image.image.data.buffer as ArrayBuffer;
      onPicture(name, await remote.call('judge', image, { transfer: [buffer] }));
    }
  } finally {
    remote.end();
  }
}

/**
 * Reads an image with the preset's own precision, which is prepared temporarily if the clouds lack
 * it.
 */
async function readWith(
  viewer: Viewer,
  clouds: readonly SplatCloud[],
  name: AccuracyPreset,
  signal: AbortSignal,
): Promise<ImageOnBackground | null> {
  const accuracy = ACCURACY_PRESETS[name];
  const leases = clouds.map((cloud) => cloud.hold(accuracy, { signal }));
  try {
    await Promise.all(leases.map(({ met }) => met));
    return await viewer.readImage({ accuracy });
  } finally {
    for (const lease of leases) lease.release();
  }
}
