/** Times of one thing measured several times, in milliseconds. */
export interface TimeSpread {
  readonly median: number;
  /** An interval that holds the true median with 95 % confidence, or all that was measured where that is too little. */
  readonly low: number;
  readonly high: number;
  /** 99th percentile, nearest rank. */
  readonly p99: number;
}

const CONFIDENCE = 0.95;

/**
 * Median and spread of `values`, at least one. The interval runs between two of the sorted values and assumes nothing
 * about how they are distributed: the number of values under the true median is binomial, whatever they are.
 */
export function timeSpread(values: readonly number[]): TimeSpread {
  const sorted = [...values].sort((a, b) => a - b);
  const count = sorted.length;
  const middle = (count - 1) / 2;
  const outer = outerRank(count);
  return {
    median: (sorted[Math.floor(middle)] + sorted[Math.ceil(middle)]) / 2,
    low: sorted[outer],
    high: sorted[count - 1 - outer],
    p99: sorted[Math.ceil(0.99 * count) - 1],
  };
}

/**
 * How many of the least, and of the greatest, of `count` values lie outside of the interval: as many as leave a chance
 * under (1 − CONFIDENCE)/2 that no more values than these lie under the true median.
 */
function outerRank(count: number): number {
  let chance = 0.5 ** count;
  let cumulated = chance;
  let rank = 0;
  while (cumulated <= (1 - CONFIDENCE) / 2) {
    rank++;
    chance *= (count - rank + 1) / rank;
    cumulated += chance;
  }
  return Math.max(0, rank - 1);
}

/** Whether the times cannot be told apart. */
export function overlap(a: TimeSpread, b: TimeSpread): boolean {
  return a.low <= b.high && b.low <= a.high;
}
