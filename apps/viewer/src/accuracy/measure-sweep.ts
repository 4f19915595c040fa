import { isSoftwareAdapter } from '@websplatter/core';
import {
  type AccuracyTable,
  countMeasureSteps,
  type MeasureAccuracyOptions,
  measureAccuracy,
} from '@websplatter/core/measure';
import type { ShownFrame } from '../engine/drawn-frame.ts';

/** A software rasteriser takes as long for a frame as a GPU for a hundred, and varies less. */
const SOFTWARE_FRAMES = 3;

type SweepOptions = Pick<MeasureAccuracyOptions, 'settings' | 'ablations' | 'combinations' | 'frames'>;

/**
 * Measures costs of accuracy for a frame, with the presets or with all settings.
 *
 * @returns the table and, of presets, how long all settings would take, ms.
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
  // Combinations are those of settings, and take many frames to find.
  const combinations = sweep === 'settings' && !isSoftware;
  return { ...presets, combinations, ...(isSoftware && { frames: SOFTWARE_FRAMES }) };
}
