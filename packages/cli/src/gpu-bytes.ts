import {
  ACCURACY_PRESETS,
  type AccuracyPreset,
  type GeometryPrecision,
  type ShDegree,
  shRestWordsPerSplat,
} from '@websplatter/core';

const GEOMETRY_BYTES_PER_SPLAT: Readonly<Record<GeometryPrecision, number>> = { f32: 64, packed: 32 };

/** Bytes that `count` splats take on the GPU, by accuracy preset, without what a view needs for those it sees. */
export function gpuBytesPerPreset(count: number, shDegree: ShDegree): Record<AccuracyPreset, number> {
  const bytes = Object.entries(ACCURACY_PRESETS).map(([preset, { geometryPrecision, shPrecision }]) => [
    preset,
    count * (GEOMETRY_BYTES_PER_SPLAT[geometryPrecision] + 4 * shRestWordsPerSplat(shDegree, shPrecision)),
  ]);
  return Object.fromEntries(bytes);
}
