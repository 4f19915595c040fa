import { describe, expect, it } from 'vitest';
import { summarize } from './time-summary.ts';

describe('the summary of times', () => {
  it('has their middle, the longest but for a hundredth, the longest and the mean', () => {
    const times = Array.from({ length: 200 }, (_, i) => 200 - i);
    expect(summarize(times)).toEqual({ median: 100.5, p99: 198, peak: 200, mean: 100.5 });
    expect(summarize([5, 1, 9])).toEqual({ median: 5, p99: 9, peak: 9, mean: 5 });
  });

  it('leaves out what was not measured', () => {
    expect(summarize([Number.NaN, 3, 1])).toMatchObject({ median: 2, peak: 3, mean: 2 });
  });

  it('knows nothing of no times', () => {
    const unknown = Number.NaN;
    expect(summarize([])).toEqual({ median: unknown, p99: unknown, peak: unknown, mean: unknown });
  });
});
