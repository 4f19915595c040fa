import type { AccuracyPoint } from '@websplatter/core/measure';
import { describeMeasured } from '../ui/accuracy-words.ts';

/** Columns of the table of measured settings. */
export const POINT_COLUMNS = ['name', 'psnr', 'time'] as const;
export type PointColumn = (typeof POINT_COLUMNS)[number];

export interface PointOrder {
  readonly by: PointColumn;
  readonly isDescending: boolean;
}

/** The most exact first. */
export const FIRST_ORDER: PointOrder = { by: 'psnr', isDescending: true };

/** The order after a click on a column's head: its best first; reversed by a second click. */
export function orderAfter(order: PointOrder, by: PointColumn): PointOrder {
  return order.by === by ? { by, isDescending: !order.isDescending } : { by, isDescending: by === 'psnr' };
}

/** The places of `points` in their table in this order. Ties are ordered by time. */
export function sortedPoints(
  points: readonly AccuracyPoint[],
  { by, isDescending }: PointOrder,
): readonly number[] {
  const sign = isDescending ? -1 : 1;
  return points
    .map((_, index) => index)
    .sort((a, b) => {
      const [first, second] = [points[a], points[b]];
      return sign * COMPARE[by](first, second) || COMPARE.time(first, second);
    });
}

const COMPARE: Readonly<Record<PointColumn, (a: AccuracyPoint, b: AccuracyPoint) => number>> = {
  name: (a, b) => describeMeasured(a).localeCompare(describeMeasured(b), 'en', { numeric: true }),
  // Equal images have infinite ratios, whose difference is no number.
  psnr: (a, b) => (a.error.psnrDb === b.error.psnrDb ? 0 : a.error.psnrDb - b.error.psnrDb),
  time: (a, b) => a.timeMs.total.median - b.timeMs.total.median,
};
