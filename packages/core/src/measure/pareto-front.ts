import type { TimeSpread } from './time-spread.ts';

/** Accuracy and time of one set of settings. */
export interface Tradeoff {
  readonly psnrDb: number;
  readonly totalMs: TimeSpread;
}

/**
 * Returns the points that no other point beats in both accuracy and time, as far as the times can
 * be told apart: from the most accurate to the fastest, every further point must save time beyond
 * the intervals. A saving that drowns in the spread has not been measured.
 *
 * @returns the points on the front, most accurate first.
 */
export function paretoFront<Point extends Tradeoff>(points: readonly Point[]): Point[] {
  const front: Point[] = [];
  const byAccuracy = [...points].sort((a, b) => {
    // Compare instead of subtracting: Infinity − Infinity is NaN.
    if (a.psnrDb !== b.psnrDb) return a.psnrDb > b.psnrDb ? -1 : 1;
    return a.totalMs.median - b.totalMs.median;
  });
  for (const point of byAccuracy) {
    const last = front.at(-1);
    if (!last || point.totalMs.high < last.totalMs.low) front.push(point);
  }
  return front;
}
