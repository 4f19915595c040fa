import {
  ACCURACY_PRESETS,
  type AccuracyPreset,
  GEOMETRY_WORDS,
  type ShDegree,
  type ShPrecision,
  shWordsPerSplat,
} from '@websplatter/core';

/**
 * Bytes that `count` splats take on the GPU, by accuracy preset, without the buffers of a view for visible splats.
 *
 * @param paletteEntries of the file's own palette, which is stored whatever the preset; null if it has none.
 */
export function gpuBytesPerPreset(
  count: number,
  shDegree: ShDegree,
  paletteEntries: number | null,
): Record<AccuracyPreset, number> {
  const shBytes = (precision: ShPrecision) => {
    if (precision !== 'palette' && paletteEntries === null)
      return 4 * count * shWordsPerSplat(shDegree, precision);
    if (shDegree === 0) return 0;
    return 4 * (paletteEntries ?? 0) * shWordsPerSplat(shDegree, 'f32') + 4 * Math.ceil(count / 2);
  };
  const bytes = Object.entries(ACCURACY_PRESETS).map(([preset, { geometryPrecision, shPrecision }]) => [
    preset,
    4 * count * GEOMETRY_WORDS[geometryPrecision] + shBytes(shPrecision),
  ]);
  return Object.fromEntries(bytes);
}
