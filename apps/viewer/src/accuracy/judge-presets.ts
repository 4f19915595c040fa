import { ACCURACY_PRESETS, type AccuracyPreset, type SplatCloud } from '@websplatter/core';
import { askWorker } from '../engine/ask-worker.ts';
import type { ImageOnBackground } from '../engine/drawn-frame.ts';
import { allClouds } from '../engine/shown-scene.ts';
import type { Viewer } from '../engine/viewer.ts';
import type { JudgedPicture } from '../state/measured.ts';

/**
 * Draws the frame on the screen with each preset, off the screen, and compares it with `reference`,
 * the first of them.
 */
export async function judgePresets(
  viewer: Viewer,
  others: readonly AccuracyPreset[],
  signal: AbortSignal,
  onPicture: (name: AccuracyPreset, picture: JudgedPicture) => void,
): Promise<void> {
  const worker = new Worker(new URL('./worst-crop.worker.ts', import.meta.url), { type: 'module' });
  try {
    for (const name of ['reference', ...others] as const) {
      const scene = viewer.scenes.newest;
      if (!scene) return;
      const image = await readWith(viewer, allClouds(scene), name, signal);
      if (!image || signal.aborted) return;
      const buffer = image.image.data.buffer as ArrayBuffer;
      onPicture(name, await askWorker<JudgedPicture>(worker, image, [buffer]));
    }
  } finally {
    worker.terminate();
  }
}

/** Reads the image with the clouds in the preset's own precision, which they may not hold otherwise. */
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
