import { type AccuracySettings, DEFAULT_ACCURACY, resolveAccuracy } from '@websplatter/core';

/**
 * Settings for a device for which none were chosen: the fastest known among those that are at least
 * as exact as the engine's default. A CPU takes long to convert 16-bit floats, which save a GPU
 * memory traffic: there the most exact settings take less time.
 */
export function defaultAccuracyOn(isSoftwareAdapter: boolean): AccuracySettings {
  return resolveAccuracy(isSoftwareAdapter ? 'reference' : DEFAULT_ACCURACY);
}
