import fc from 'fast-check';
import { describe, expect, test } from 'vitest';
import { seededRandom } from '../testing/seeded-random.ts';
import { paretoFront } from './pareto-front.ts';
import { overlap, standardDeviation, type TimeSpread, timeSpread } from './time-spread.ts';

describe('timeSpread', () => {
  test('returns the order statistics in the tables of the sign test', () => {
    const upTo = (count: number) => Array.from({ length: count }, (_, i) => count - i);
    expect(timeSpread(upTo(15))).toEqual({ median: 8, low: 4, high: 12, p99: 15 });
    expect(timeSpread(upTo(20))).toEqual({ median: 10.5, low: 6, high: 15, p99: 20 });
    expect(timeSpread(upTo(6))).toMatchObject({ low: 1, high: 6 });
    expect(timeSpread(upTo(9))).toMatchObject({ low: 2, high: 8 });
    expect(timeSpread(upTo(200)).p99).toBe(198);
  });

  test('spans all values if there are too few', () => {
    expect(timeSpread([3])).toEqual({ median: 3, low: 3, high: 3, p99: 3 });
    expect(timeSpread([5, 1, 3])).toMatchObject({ median: 3, low: 1, high: 5 });
  });

  test('contains the median in 95 of 100 cases, however times are distributed', () => {
    const random = seededRandom(5);
    const TRIALS = 2000;
    let hits = 0;
    for (let trial = 0; trial < TRIALS; trial++) {
      // Skewed, as times are; the median of u⁻¹ is 2.
      const { low, high } = timeSpread(Array.from({ length: 15 }, () => 1 / (1 - random())));
      if (low <= 2 && 2 <= high) hits++;
    }
    expect(hits / TRIALS).toBeGreaterThan(0.95);
  });

  test('the standard deviation is that of all values about their mean', () => {
    expect(standardDeviation([2, 4, 4, 4, 5, 5, 7, 9])).toBe(2);
    expect(standardDeviation([3])).toBe(0);
  });

  test('overlap is symmetric, and touching is overlapping', () => {
    const between = (low: number, high: number): TimeSpread => ({ median: low, low, high, p99: high });
    expect(overlap(between(1, 2), between(2, 3))).toBe(true);
    expect(overlap(between(2, 3), between(1, 2))).toBe(true);
    expect(overlap(between(1, 2), between(2.1, 3))).toBe(false);
  });
});

describe('paretoFront', () => {
  const point = (psnrDb: number, low: number, high = low) => ({
    psnrDb,
    totalMs: { median: (low + high) / 2, low, high, p99: high },
  });

  test('keeps points that are more accurate or faster, most accurate first', () => {
    const [exact, good, poor, bad] = [point(Infinity, 9), point(60, 5), point(40, 2), point(39, 3)];
    expect(paretoFront([poor, bad, exact, good])).toEqual([exact, good, poor]);
  });

  test('keeps the faster of equally accurate points', () => {
    expect(paretoFront([point(50, 4), point(50, 3)])).toEqual([point(50, 3)]);
    expect(paretoFront([point(Infinity, 4), point(Infinity, 3)])).toEqual([point(Infinity, 3)]);
  });

  test('ignores savings within the spread of the times', () => {
    const [exact, same, faster] = [point(60, 5, 6), point(50, 4.5, 5.2), point(45, 4, 4.4)];
    expect(paretoFront([exact, same, faster])).toEqual([exact, faster]);
  });

  test('no point is both more accurate and clearly faster than one on the front', () => {
    const points = fc.array(
      fc.tuple(
        fc.integer({ min: 20, max: 70 }),
        fc.integer({ min: 1, max: 50 }),
        fc.integer({ min: 0, max: 9 }),
      ),
      { minLength: 1 },
    );
    fc.assert(
      fc.property(points, (drawn) => {
        const all = drawn.map(([psnrDb, low, width]) => point(psnrDb, low, low + width));
        const front = paretoFront(all);
        expect(front.length).toBeGreaterThan(0);
        for (const [i, kept] of front.entries()) {
          if (i > 0) expect(kept.totalMs.high).toBeLessThan(front[i - 1].totalMs.low);
          for (const other of all)
            expect(other.psnrDb > kept.psnrDb && other.totalMs.high < kept.totalMs.low).toBe(false);
        }
      }),
    );
  });
});
