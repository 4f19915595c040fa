export interface Spread {
  readonly median: number;
  readonly p99: number;
}

/** Returns median and 99th percentile (nearest rank), null if no value is a number. */
export function spreadOf(values: readonly number[]): Spread | null {
  const sorted = values.filter((value) => !Number.isNaN(value)).sort((a, b) => a - b);
  if (sorted.length === 0) return null;
  const middle = (sorted.length - 1) / 2;
  return {
    median: (sorted[Math.floor(middle)] + sorted[Math.ceil(middle)]) / 2,
    p99: sorted[Math.ceil(0.99 * sorted.length) - 1],
  };
}
