/** What a row of times is like, ms. NaN of everything where there is none. */
export interface TimeSummary {
  readonly median: number;
  /** Nearest rank: 99 of 100 times do not exceed it. */
  readonly p99: number;
  readonly peak: number;
  readonly mean: number;
}

/** @param times in any order; what is not finite is left out. */
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
