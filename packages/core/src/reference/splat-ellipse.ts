import { reachSquared } from './stacked-opacity.ts';

/** The visible part of a splat, in float64. Lengths in pixels, y down. */
export interface SplatEllipse {
  readonly centerPx: readonly [number, number];
  /** Half width and half height of its box. */
  readonly extentPx: readonly [number, number];
  /** Height above the centre of the point farthest to the right. */
  readonly rightmostPx: number;
  /** The middle of a row moves sideways by this much per pixel of height. */
  readonly shear: number;
  /** Half width of a row, per √(distance to the top · distance to the bottom). */
  readonly slimness: number;
}

/** The fields of a record that its ellipse depends on; see `DecodedRecord`. */
export interface EllipseRecord {
  readonly centerPx: readonly number[];
  /** Half axes at √2 standard deviations. */
  readonly majorPx: readonly number[];
  readonly minorPx: readonly number[];
  /** r, g, b and opacity. */
  readonly color: readonly number[];
}

/** Reference of lib/splat-ellipse.wgsl: where a splat reaches the cutoff; null if nowhere. */
export function splatEllipse(record: EllipseRecord, alphaCutoff: number): SplatEllipse | null {
  const opacity = record.color[3];
  if (opacity < alphaCutoff) return null;
  const reach = Math.sqrt(reachSquared(opacity, alphaCutoff));
  const [[majorX, majorY], [minorX, minorY]] = [record.majorPx, record.minorPx];
  const halfX = Math.hypot(majorX, minorX);
  const halfY = Math.hypot(majorY, minorY);
  const skew = majorX * majorY + minorX * minorY;
  const area = Math.abs(majorX * minorY - majorY * minorX);
  return {
    centerPx: [record.centerPx[0], record.centerPx[1]],
    extentPx: [reach * halfX, reach * halfY],
    rightmostPx: (reach * skew) / halfX,
    shear: skew / halfY / halfY,
    slimness: area / halfY / halfY,
  };
}

/** First and last of a number of columns or rows; none if first > last. */
export type Span = readonly [first: number, last: number];

const NONE: Span = [1, 0];

/**
 * Returns the columns, `widthPx` wide from x = `left`, that have a pixel centre of the part of the
 * ellipse between two rows of pixel centres.
 *
 * @param slackPx how far the ellipse is widened. The shader widens by a hundredth of a pixel or
 *   more.
 */
export function touchedColumns(
  { centerPx, extentPx, rightmostPx, shear, slimness }: SplatEllipse,
  [firstRowPx, lastRowPx]: readonly [number, number],
  { left, widthPx, columns }: { readonly left: number; readonly widthPx: number; readonly columns: number },
  slackPx = 0,
): Span {
  const low = Math.max(firstRowPx - slackPx - centerPx[1], -extentPx[1]);
  const high = Math.min(lastRowPx + slackPx - centerPx[1], extentPx[1]);
  if (!(low <= high)) return NONE;
  const clamped = (y: number) => Math.min(Math.max(y, low), high);
  const halfWidth = (y: number) => slimness * Math.sqrt(Math.max(0, (extentPx[1] - y) * (extentPx[1] + y)));
  const [atRight, atLeft] = [clamped(rightmostPx), clamped(-rightmostPx)];
  const x = centerPx[0] - left;
  const rightmost = x + shear * atRight + halfWidth(atRight) + slackPx;
  const leftmost = x + shear * atLeft - halfWidth(atLeft) - slackPx;
  return spanOf(leftmost, rightmost, widthPx, columns);
}

/** Returns the rows, `heightPx` high, that have a pixel centre of the ellipse's box. */
export function touchedRows(
  { centerPx, extentPx }: SplatEllipse,
  heightPx: number,
  rows: number,
  slackPx = 0,
): Span {
  const reach = extentPx[1] + slackPx;
  return spanOf(centerPx[1] - reach, centerPx[1] + reach, heightPx, rows);
}

/** Cells of a size that have a pixel centre in from…to; pixel centres lie at half-integers. */
function spanOf(from: number, to: number, sizePx: number, cells: number): Span {
  const first = Math.max(0, Math.ceil((from + 0.5) / sizePx) - 1);
  const last = Math.min(cells - 1, Math.floor((to - 0.5) / sizePx));
  return first <= last ? [first, last] : NONE;
}
