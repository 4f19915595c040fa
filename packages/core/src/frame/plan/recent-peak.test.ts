import fc from 'fast-check';
import { describe, expect, test } from 'vitest';
import { RecentPeak } from './recent-peak.ts';

const FRAME_MS = 1000 / 60;

/** Takes `count` frames of the same need from `atMs` on; returns when the last was drawn. */
function take(peak: RecentPeak, value: number, count: number, atMs: number): number {
  for (let i = 0; i < count; i++) peak.take(value, atMs + i * FRAME_MS);
  return atMs + count * FRAME_MS;
}

describe('RecentPeak', () => {
  test('is 0 before the first frame', () => {
    const peak = new RecentPeak(2000);
    expect(peak.value).toBe(0);
    peak.take(5, 0);
    expect(peak.value).toBe(5);
  });

  test('stands for two seconds at least, and for four at most', () => {
    const peak = new RecentPeak(2000);
    let now = take(peak, 100, 200, 0);
    now = take(peak, 10, 118, now);
    expect(peak.value).toBe(100);
    take(peak, 10, 130, now);
    expect(peak.value).toBe(10);
  });

  test('stands while nothing is drawn, and while few frames are drawn', () => {
    const peak = new RecentPeak(2000);
    take(peak, 100, 200, 0);
    for (let i = 0; i < 28; i++) peak.take(10, 1e6 + 1e4 * i);
    expect(peak.value).toBe(100);
  });

  test('stands while fast frames take less than two seconds', () => {
    const peak = new RecentPeak(2000);
    for (let i = 0; i < 1000; i++) peak.take(i === 0 ? 100 : 10, i);
    expect(peak.value).toBe(100);
  });

  test('stands longer each time that the need returns', () => {
    const peak = new RecentPeak(2000);
    let drops = 0;
    let now = 0;
    // Rounds of 20 s, with a need that is low for most of them.
    for (let round = 0; round < 20; round++) {
      // It rises step by step.
      for (const value of [20, 40, 60, 80, 100]) now = take(peak, value, 40, now);
      now = take(peak, 10, 1000, now);
      if (peak.value === 10) drops++;
    }
    expect(drops).toBeGreaterThan(0);
    expect(drops).toBeLessThan(5);
  });

  test('does not wait longer for a need that never returns', () => {
    const peak = new RecentPeak(2000);
    let now = 0;
    for (const value of [1000, 300, 90, 27, 8]) {
      now = take(peak, value, 130, now);
      now = take(peak, value, 250, now);
      expect(peak.value).toBe(value);
    }
  });

  test('is never less than the last need, and never more than the largest', () => {
    const steps = fc.array(fc.tuple(fc.nat(1000), fc.nat(500)), { minLength: 1, maxLength: 500 });
    fc.assert(
      fc.property(steps, (frames) => {
        const peak = new RecentPeak(2000);
        let now = 0;
        let largest = 0;
        for (const [value, elapsedMs] of frames) {
          now += elapsedMs;
          largest = Math.max(largest, value);
          peak.take(value, now);
          expect(peak.value).toBeGreaterThanOrEqual(value);
          expect(peak.value).toBeLessThanOrEqual(largest);
        }
      }),
    );
  });
});
