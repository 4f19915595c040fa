import type { TimeSpread } from './time-spread.ts';

/** Accuracy and time of one set of settings. */
export interface Tradeoff {
  readonly psnrDb: number;
  readonly totalMs: TimeSpread;
}

/**
 * Returns the Pareto front: points that no other point beats in both accuracy and time. From the
 * most accurate to the fastest, each further point must save time beyond the intervals; a saving
 * within the spread is not measurable.
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
