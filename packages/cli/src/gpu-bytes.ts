import {
  ACCURACY_PRESETS,
  type AccuracyPreset,
  GEOMETRY_WORDS,
  type ShDegree,
  shPlaneBytes,
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
  const bytes = Object.entries(ACCURACY_PRESETS).map(([preset, { geometryPrecision, shPrecision }]) => [
    preset,
    4 * count * GEOMETRY_WORDS[geometryPrecision] +
      shPlaneBytes(count, shDegree, paletteEntries === null ? shPrecision : 'palette', paletteEntries ?? 0),
  ]);
  return Object.fromEntries(bytes);
}
