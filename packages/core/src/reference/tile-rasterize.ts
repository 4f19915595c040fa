import { MAX_FRAGMENT_ALPHA } from '../data/accuracy/accuracy.ts';
import type { EllipseRecord } from './splat-ellipse.ts';
import { stackedAlpha } from './stacked-opacity.ts';

/** A pixel ends when less of the light behind it passes through. */
export const OPAQUE = 2 ** -16;

/** A record as a tile blends it. */
export interface BlendedRecord extends EllipseRecord {
  readonly depthView: number;
}

/** A blended pixel. */
export interface TilePixel {
  /** Premultiplied r, g, b, and opacity. */
  readonly rgba: readonly [number, number, number, number];
  /**
   * Median depth: the view depth of the splat that makes the pixel more than half covered, or of
   * the last one, times the opacity.
   */
  readonly depthView: number;
  /** Number of records that were looked at before the pixel ended. */
  readonly tested: number;
}

/**
 * Reference of tile-rasterize for one pixel: blends records front to back.
 *
 * @param ranked records, nearest first.
 * @param hostDepthView view depth behind which splats are hidden; default nothing is.
 */
export function tilePixel(
  ranked: readonly BlendedRecord[],
  [xPx, yPx]: readonly [number, number],
  alphaCutoff: number,
  hostDepthView = Number.POSITIVE_INFINITY,
): TilePixel {
  const rgb: [number, number, number] = [0, 0, 0];
  let [transmittance, depthView, tested] = [1, 0, 0];
  for (const record of ranked) {
    if (transmittance < OPAQUE) break;
    tested++;
    const alpha = alphaAt(record, xPx, yPx);
    if (alpha < alphaCutoff || record.depthView > hostDepthView) continue;
    const weight = alpha * transmittance;
    for (let channel = 0; channel < 3; channel++) rgb[channel] += record.color[channel] * weight;
    if (transmittance > 0.5) ({ depthView } = record);
    transmittance -= weight;
  }
  return { rgba: [...rgb, 1 - transmittance], depthView: depthView * (1 - transmittance), tested };
}

/** Opacity of a record at the centre of a pixel. */
export function alphaAt(record: EllipseRecord, xPx: number, yPx: number): number {
  const { centerPx, majorPx, minorPx, color } = record;
  const [x, y] = [xPx + 0.5 - centerPx[0], yPx + 0.5 - centerPx[1]];
  const area = majorPx[0] * minorPx[1] - majorPx[1] * minorPx[0];
  const along = (x * minorPx[1] - y * minorPx[0]) / area;
  const across = (majorPx[0] * y - majorPx[1] * x) / area;
  const gaussian = Math.exp(-(along * along + across * across));
  return Math.min(MAX_FRAGMENT_ALPHA, stackedAlpha(color[3], gaussian));
}
