import fc from 'fast-check';
import { describe, expect, test } from 'vitest';
import { SubmissionPacer, type Work } from './submission-pacer.ts';

const BUDGET_MS = 250;

/** Times of the slowest device, ms, for the units before each, then for all. */
function sumsOf(unitsMs: readonly number[]): Float64Array {
  const sums = new Float64Array(unitsMs.length + 1);
  for (const [i, ms] of unitsMs.entries()) sums[i + 1] = sums[i] + ms;
  return sums;
}

/** The time that a clock tells in multiples of `tickMs`; 0: exactly. */
function told(ms: number, tickMs: number): number {
  return tickMs === 0 ? ms : tickMs * Math.floor(ms / tickMs);
}

/**
 * Submits all units in turn on a device that takes `shareAt(unit)` of the slowest device's time for
 * each, by a clock that tells multiples of `tickMs`. Returns the time and the number of units of
 * each submission.
 */
function submitAll(
  pacer: SubmissionPacer,
  unitsMs: readonly number[],
  shareAt: (unit: number) => number,
  tickMs = 0,
) {
  let nowMs = 0;
  const sums = sumsOf(unitsMs);
  const submissions: { readonly ms: number; readonly units: number }[] = [];
  for (let first = 0; first < unitsMs.length; ) {
    const units = Math.min(pacer.unitsFrom(first, 'stage', sums), unitsMs.length - first);
    const work = { stage: 'stage', slowestMs: sums[first + units] - sums[first] };
    const ms = unitsMs
      .slice(first, first + units)
      .reduce((sum, unitMs, i) => sum + unitMs * shareAt(first + i), 0);
    pacer.take([work], told(nowMs + ms, tickMs) - told(nowMs, tickMs));
    nowMs += ms;
    submissions.push({ ms, units });
    first += units;
  }
  return submissions;
}

/** Whether all of `work` may follow in the submission of work that takes no time. */
function fit(pacer: SubmissionPacer, work: readonly Work[]): boolean {
  const [{ stage }] = work;
  return pacer.fittingFrom(0, [{ stage, slowestMs: 0 }, ...work]) === 1 + work.length;
}

/** Times of units on the slowest device, each far shorter than the budget. */
const units = fc.array(fc.double({ min: 1e-4, max: 5, noNaN: true }), {
  minLength: 1,
  maxLength: 2000,
  // By default fast-check tries about ten.
  size: 'max',
});

describe('SubmissionPacer', () => {
  test('keeps every submission within the budget, on any device as fast as the slowest or faster', () => {
    const share = fc.double({ min: 1e-6, max: 1, noNaN: true });
    fc.assert(
      fc.property(units, share, (unitsMs, share) => {
        const submissions = submitAll(new SubmissionPacer(BUDGET_MS), unitsMs, () => share);
        expect(Math.max(...submissions.map(({ ms }) => ms))).toBeLessThanOrEqual(BUDGET_MS);
        expect(submissions.reduce((sum, { units }) => sum + units, 0)).toBe(unitsMs.length);
      }),
    );
  });

  /**
   * @fault Time: work becomes four times harder within a frame
   * @consequence submissions stay within the budget
   */
  test('keeps within the budget where work becomes four times harder from one unit to the next', () => {
    // A submission aims at a quarter of the budget.
    fc.assert(
      fc.property(units, fc.double({ min: 1e-6, max: 1 / 4, noNaN: true }), (unitsMs, share) => {
        const hardFrom = unitsMs.length / 2;
        const shareAt = (unit: number) => (unit < hardFrom ? share : 4 * share);
        const submissions = submitAll(new SubmissionPacer(BUDGET_MS), unitsMs, shareAt);
        expect(Math.max(...submissions.map(({ ms }) => ms))).toBeLessThanOrEqual(BUDGET_MS);
      }),
    );
  });

  test('trusts work that becomes easy only step by step', () => {
    const unitsMs = Array.from({ length: 4000 }, () => 5);
    const submissions = submitAll(new SubmissionPacer(BUDGET_MS), unitsMs, () => 1e-6);
    expect(submissions.map(({ units }) => units)).toEqual([12, 50, 200, 800, 2938]);
  });

  /**
   * @fault Time: the clock ticks in whole milliseconds, frames or tenths of a second
   * @consequence submissions stay short, and nothing stalls
   */
  test('keeps within the budget by a clock that tells whole milliseconds or frames, and stalls by none', () => {
    const share = fc.integer({ min: 1, max: 1000 }).map((thousandths) => thousandths / 1000);
    fc.assert(
      fc.property(units, share, fc.constantFrom(1, 1000 / 60, 100), (unitsMs, share, tickMs) => {
        const submitAfterOther = (tickMs: number) => {
          const pacer = new SubmissionPacer(BUDGET_MS);
          const otherMs = 60 * share;
          pacer.take([{ stage: 'other', slowestMs: 60 }], told(otherMs, tickMs));
          return submitAll(pacer, unitsMs, () => share, tickMs);
        };
        const submissions = submitAfterOther(tickMs);
        // Work of less than a tick is told to take no time: eight times as much may follow, to the
        // next unit.
        const mostMs = Math.max(BUDGET_MS, 8 * (tickMs + 5));
        expect(Math.max(...submissions.map(({ ms }) => ms))).toBeLessThanOrEqual(mostMs);
        const exact = submitAfterOther(0);
        expect(submissions.length).toBeLessThanOrEqual(exact.length * (1 + tickMs));
      }),
      // To shrink thousands of units takes minutes.
      { endOnFailure: true },
    );
  });

  test('is not misled by a thousand submissions that a clock tells to take no time', () => {
    const pacer = new SubmissionPacer(BUDGET_MS);
    const sums = sumsOf(Array.from({ length: 100_000 }, () => 5));
    pacer.take([{ stage: 'other', slowestMs: 60 }], 0);
    // The slowest device would take 500 s.
    expect(pacer.unitsFrom(0, 'stage', sums)).toBeLessThan(100);
    for (let i = 0; i < 1000; i++) pacer.take([{ stage: 'stage', slowestMs: 100 }], 0);
    expect(pacer.unitsFrom(0, 'stage', sums)).toBeLessThan(2000);
    pacer.take([{ stage: 'stage', slowestMs: 100 }], 100);
    expect(pacer.unitsFrom(0, 'stage', sums)).toBe(12);
  });

  test('submits a unit alone that is longer than the budget: nothing is shorter', () => {
    expect(submitAll(new SubmissionPacer(BUDGET_MS), [1000, 1000], () => 1)).toEqual([
      { ms: 1000, units: 1 },
      { ms: 1000, units: 1 },
    ]);
  });

  test('takes a stage that was never measured for eight times slower than others', () => {
    const pacer = new SubmissionPacer(BUDGET_MS);
    const work = (stage: string, slowestMs: number) => ({ stage, slowestMs });
    expect(fit(pacer, [work('first', 62)])).toBe(true);
    expect(fit(pacer, [work('first', 63)])).toBe(false);
    pacer.take([work('first', 1000)], 1);
    expect(fit(pacer, [work('second', 7800)])).toBe(true);
    expect(fit(pacer, [work('second', 7900)])).toBe(false);
    expect(fit(pacer, [work('second', 4000), work('third', 4000)])).toBe(false);
  });

  test('tells nothing of other stages by the time of work that was guessed', () => {
    const pacer = new SubmissionPacer(BUDGET_MS);
    pacer.take([{ stage: 'first', slowestMs: 62 }], 62);
    // The guess may be a thousand times too large.
    pacer.take([{ stage: 'guessed', slowestMs: 65_536, isGuess: true }], 60);
    expect(fit(pacer, [{ stage: 'second', slowestMs: 62 }])).toBe(true);
    expect(fit(pacer, [{ stage: 'second', slowestMs: 63 }])).toBe(false);
  });

  test('takes the time of stages together in proportion, and at once when it is longer', () => {
    const pacer = new SubmissionPacer(BUDGET_MS);
    const both = [
      { stage: 'a', slowestMs: 10 },
      { stage: 'b', slowestMs: 30 },
    ];
    pacer.take(both, 80);
    expect(fit(pacer, both)).toBe(false);
    expect(fit(pacer, [{ stage: 'a', slowestMs: 31 }])).toBe(true);
    expect(fit(pacer, [{ stage: 'b', slowestMs: 32 }])).toBe(false);
  });

  /**
   * @fault Time: a frame has ten thousand clouds
   * @consequence CPU time grows with their number, because each command is looked at once
   */
  test('looks at each of many commands a few times only', () => {
    let looks = 0;
    const work = Array.from({ length: 10_000 }, () => ({
      stage: 'project',
      get slowestMs() {
        looks++;
        return 0.001;
      },
    }));
    const pacer = new SubmissionPacer(BUDGET_MS);
    expect(pacer.fittingFrom(0, work)).toBe(10_000);
    expect(looks).toBeLessThanOrEqual(2 * work.length);
  });
});
