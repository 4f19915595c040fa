import { checkKind } from '../data/given.ts';

/** Spread of repeated measurements of one time, in milliseconds. */
export interface TimeSpread {
  readonly median: number;
  /**
   * An interval that holds the true median with 95 % confidence; all values if they are too few.
   */
  readonly low: number;
  readonly high: number;
  /** 99th percentile, nearest rank. */
  readonly p99: number;
}

const CONFIDENCE = 0.95;

/**
 * Returns median and spread of `values`, at least one. The interval runs between two of the sorted
 * values and assumes nothing about their distribution: the number of values below the true median
 * is always binomial.
 *
 * @example
 * const timesMs: number[] = [];
 * view.onStatistics = ({ timing }) => {
 *   timesMs.push(timing.totalMs);
 *   const { median, low, high } = timeSpread(timesMs);
 *   label.textContent = `${median} ms (${low} to ${high})`;
 * };
 */
export function timeSpread(values: readonly number[]): TimeSpread {
  checkKind('values', values, 'a list');
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
 * Returns the standard deviation of `values`, at least one, about their mean.
 *
 * @example
 * const timesMs = [4.1, 4.3, 4.2, 5.9];
 * const isSteady = standardDeviation(timesMs) < 0.1 * timeSpread(timesMs).median; // false
 */
export function standardDeviation(values: readonly number[]): number {
  const mean = values.reduce((sum, value) => sum + value, 0) / values.length;
  return Math.sqrt(values.reduce((sum, value) => sum + (value - mean) ** 2, 0) / values.length);
}

/**
 * Returns how many of the least, and of the greatest, of `count` values lie outside the interval:
 * as many as keep the chance below (1 − CONFIDENCE)/2 that no more values than these lie below the
 * true median.
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

/** Whether the intervals overlap: the times then have no measurable difference. */
export function overlap(a: TimeSpread, b: TimeSpread): boolean {
  return a.low <= b.high && b.low <= a.high;
}
