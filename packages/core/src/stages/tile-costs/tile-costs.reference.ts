import type { EllipseRecord } from '../../reference/splat-ellipse.ts';
import { alphaAt, OPAQUE } from '../tiles/tiles.reference.ts';

/** Costs and picture of one pixel. */
export interface ReferencePixelCosts {
  /** Records evaluated until the pixel is opaque. */
  readonly steps: number;
  /** Evaluated records whose alpha reaches the cutoff at this pixel. */
  readonly blended: number;
  /** All records of the tile's list whose alpha reaches the cutoff at this pixel. */
  readonly fragments: number;
  /** Each listed record's share of the pixel: opacity times transmittance in front of it. */
  readonly weights: readonly number[];
}

/** Reference of tile-costs for one pixel. @param listed its tile's list, nearest first. */
export function pixelCosts(
  listed: readonly EllipseRecord[],
  [xPx, yPx]: readonly [number, number],
  alphaCutoff: number,
): ReferencePixelCosts {
  let [transmittance, steps, blended, fragments] = [1, 0, 0, 0];
  const weights = listed.map((record) => {
    const alpha = alphaAt(record, xPx, yPx);
    const isDrawn = alpha >= alphaCutoff;
    if (isDrawn) fragments++;
    if (transmittance < OPAQUE) return 0;
    steps++;
    if (!isDrawn) return 0;
    blended++;
    const weight = alpha * transmittance;
    transmittance -= weight;
    return weight;
  });
  return { steps, blended, fragments, weights };
}

/**
 * Reference of the stage's map for one pixel: the mean of log₂ of its records' contributions to the
 * whole picture, weighted by their contributions to this pixel; 0 if there are none.
 *
 * @param contributionsPx contributions of the same records to the whole picture, px.
 */
export function meanLogContribution(weights: readonly number[], contributionsPx: readonly number[]): number {
  const opacity = weights.reduce((sum, weight) => sum + weight, 0);
  const sum = weights.reduce((total, weight, i) => total + weight * Math.log2(contributionsPx[i] || 1), 0);
  return opacity > 0 ? sum / opacity : 0;
}
