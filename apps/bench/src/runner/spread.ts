/** Middle and tail of repeated times. */
export interface Spread {
  readonly median: number;
  /** Nearest rank. */
  readonly p99: number;
  /** Standard deviation as a part of the mean. */
  readonly deviation: number;
}

/** Null for no values. */
export function spreadOf(values: readonly number[]): Spread | null {
  if (values.length === 0) return null;
  const sorted = values.toSorted((a, b) => a - b);
  const mean = values.reduce((sum, value) => sum + value, 0) / values.length;
  const variance = values.reduce((sum, value) => sum + (value - mean) ** 2, 0) / values.length;
  const middle = (sorted.length - 1) / 2;
  return {
    median: (sorted[Math.floor(middle)] + sorted[Math.ceil(middle)]) / 2,
    p99: sorted[Math.ceil(0.99 * sorted.length) - 1],
    deviation: mean === 0 ? 0 : Math.sqrt(variance) / mean,
  };
}
