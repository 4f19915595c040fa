import {
  ACCURACY_PRESETS,
  type AccuracyPreset,
  GEOMETRY_WORDS,
  type ShDegree,
  shWordsPerSplat,
} from '@websplatter/core';

/** Bytes that `count` splats take on the GPU, by accuracy preset, without the buffers of a view for visible splats. */
export function gpuBytesPerPreset(count: number, shDegree: ShDegree): Record<AccuracyPreset, number> {
  const bytes = Object.entries(ACCURACY_PRESETS).map(([preset, { geometryPrecision, shPrecision }]) => [
    preset,
    4 * count * (GEOMETRY_WORDS[geometryPrecision] + shWordsPerSplat(shDegree, shPrecision)),
  ]);
  return Object.fromEntries(bytes);
}
