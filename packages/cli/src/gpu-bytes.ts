import {
  ACCURACY_PRESETS,
  type AccuracyPreset,
  GEOMETRY_WORDS,
  type ShDegree,
  shWordsPerSplat,
} from '@websplatter/core';

/** GPU bytes of `count` splats by accuracy preset, without a view's buffers for visible splats. */
export function gpuBytesPerPreset(count: number, shDegree: ShDegree): Record<AccuracyPreset, number> {
  const bytes = Object.entries(ACCURACY_PRESETS).map(([preset, { geometryPrecision, shPrecision }]) => [
    preset,
    4 * count * (GEOMETRY_WORDS[geometryPrecision] + shWordsPerSplat(shDegree, shPrecision)),
  ]);
  return Object.fromEntries(bytes);
}
