import type { VisibleSplat } from '../cull/cull.reference.ts';
import { alphaAtPixel } from '../pick/pick.reference.ts';

/** A point of the scene; splats in front of it cover it. */
export interface ReferenceCoverPoint {
  /** Column and row of its pixel. */
  readonly xPx: number;
  readonly yPx: number;
  /** Splats at less view depth are in front of it, world units. */
  readonly depthView: number;
}

/** Reference of cover-points: joint opacity, 0…1, of splats in front of a point, at its pixel. */
export function coverPoint(
  splats: readonly VisibleSplat[],
  { xPx, yPx, depthView }: ReferenceCoverPoint,
  alphaCutoff: number,
): number {
  let transmittance = 1;
  for (const splat of splats) {
    if (splat.depthView < depthView) transmittance *= 1 - alphaAtPixel(splat, xPx, yPx, alphaCutoff);
  }
  return 1 - transmittance;
}
