/** Middle and tail of repeated times. */
export interface Spread {
  readonly median: number;
  /** Nearest rank. */
  readonly p99: number;
}

/** Null for no values. */
export function spreadOf(values: readonly number[]): Spread | null {
  if (values.length === 0) return null;
  const sorted = values.toSorted((a, b) => a - b);
  const middle = (sorted.length - 1) / 2;
  return {
    median: (sorted[Math.floor(middle)] + sorted[Math.ceil(middle)]) / 2,
    p99: sorted[Math.ceil(0.99 * sorted.length) - 1],
  };
}
