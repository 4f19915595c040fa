import { ACCURACY_PRESETS, type AccuracyPreset, isSoftwareAdapter, type SplatCloud } from '@websplatter/core';
import {
  type AccuracyTable,
  countMeasureSteps,
  type MeasureAccuracyOptions,
  measureAccuracy,
} from '@websplatter/core/measure';
import { Remote } from '@websplatter/core/write';
import { workerFailure } from '@websplatter/kit/worker-failure';
import { allClouds } from '../engine/open/shown-scene.ts';
import type { ImageOnBackground, ShownFrame, Viewer } from '../engine/viewer.ts';
import type { JudgedPicture } from '../state/measured.ts';
import type { ErrorMapTasks } from './error-map.worker.ts';

/** A software rasterizer takes as long for a frame as a GPU for a hundred, with less variation. */
const SOFTWARE_FRAMES = 3;

type SweepOptions = Pick<MeasureAccuracyOptions, 'settings' | 'ablations' | 'combinations' | 'frames'>;

/**
 * Measures the costs of presets, or of all settings, for a frame.
 *
 * @returns the table; for presets also the estimated time for all settings, ms.
 */
export async function measureSweep(
  { engine, frame }: ShownFrame,
  sweep: 'presets' | 'settings',
  options: Pick<MeasureAccuracyOptions, 'signal' | 'onProgress' | 'onTable'>,
): Promise<{ readonly table: AccuracyTable; readonly allSettingsMs: number | null }> {
  const { camera, clouds, widthPx, heightPx, sortBy, detail } = frame;
  const isSoftware = isSoftwareAdapter(engine.device.adapterInfo);
  const image = { clouds, cameras: [camera], widthPx, heightPx, sortBy, detail };
  const asked = { ...image, ...sweepOptions(sweep, isSoftware) };
  const table = await measureAccuracy(engine, { ...asked, ...options });
  if (sweep === 'settings') return { table, allSettingsMs: null };
  const all = countMeasureSteps({ ...image, ...sweepOptions('settings', isSoftware) });
  return { table, allSettingsMs: (table.elapsedMs * all) / countMeasureSteps(asked) };
}

function sweepOptions(sweep: 'presets' | 'settings', isSoftware: boolean): SweepOptions {
  const presets = sweep === 'presets' ? { settings: [], ablations: false } : {};
  // Combinations of settings take many frames to find.
  const combinations = sweep === 'settings' && !isSoftware;
  return { ...presets, combinations, ...(isSoftware && { frames: SOFTWARE_FRAMES }) };
}

/**
 * Draws the current frame with each preset to a texture, and compares it with `reference`, which
 * comes first.
 */
export async function judgePresets(
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
