import type { TimeSpread } from './time-spread.ts';

/** What a setting costs and what it buys. */
export interface Tradeoff {
  readonly psnrDb: number;
  readonly totalMs: TimeSpread;
}

/**
 * The points of which none is both more accurate and faster, as far as the times can be told apart: going from the most
 * accurate to the fastest, every further point has to save time beyond the intervals. A point whose saving drowns in the
 * spread buys nothing that was measured.
 *
 * @returns the points on the front, most accurate first.
 */
export function paretoFront<Point extends Tradeoff>(points: readonly Point[]): Point[] {
  const front: Point[] = [];
  const byAccuracy = [...points].sort((a, b) => {
    // Not their difference: Infinity − Infinity is no number.
    if (a.psnrDb !== b.psnrDb) return a.psnrDb > b.psnrDb ? -1 : 1;
    return a.totalMs.median - b.totalMs.median;
  });
  for (const point of byAccuracy) {
    const last = front.at(-1);
    if (!last || point.totalMs.high < last.totalMs.low) front.push(point);
  }
  return front;
}
