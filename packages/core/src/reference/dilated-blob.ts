import { LEVEL_CONSTANTS } from '../data/layout/level-structs.ts';

/** Reference of shaders/lib/dilated-blob.wgsl, in float64. */
export function dilatedOpacity(
  opacity: number,
  area: number,
  rim: number,
  [rims, opacities]: readonly [number, number],
  deviationPx: number,
  pxPerUnit: number,
): number {
  const dilation = deviationPx / pxPerUnit;
  const light = opacity * area + dilation * rims + dilation ** 2 * opacities;
  return Math.min(light / (area + dilation * rim + dilation ** 2), LEVEL_CONSTANTS.MOST_OPACITY);
}
