/** Summary of a row of times, ms; all NaN for none. */
export interface TimeSummary {
  readonly median: number;
  /** Nearest rank: 99 of 100 times do not exceed it. */
  readonly p99: number;
  readonly peak: number;
  readonly mean: number;
}

/** @param times in any order; values that are not finite are left out. */
export function summarize(times: readonly number[]): TimeSummary {
  const sorted = Float64Array.from(times.filter(Number.isFinite)).sort();
  const count = sorted.length;
  const at = (rank: number) => sorted[rank] ?? Number.NaN;
  return {
    median: (at(Math.floor((count - 1) / 2)) + at(Math.ceil((count - 1) / 2))) / 2,
    p99: at(Math.ceil(0.99 * count) - 1),
    peak: at(count - 1),
    mean: sorted.reduce((sum, time) => sum + time, 0) / count,
  };
}
