import { resolveAccuracy } from '@websplatter/core';
import type { AccuracyPoint } from '@websplatter/core/measure';
import { describe, expect, it } from 'vitest';
import { FIRST_ORDER, orderAfter, sortedPoints } from './measured-results.tsx';

function point(resolutionScale: number, psnrDb: number, median: number): AccuracyPoint {
  const settings = resolveAccuracy({ resolutionScale });
  const name = `resolutionScale ${resolutionScale}`;
  return {
    ...{ name, settings, changed: ['resolutionScale'], error: { psnrDb }, timeMs: { total: { median } } },
  } as unknown as AccuracyPoint;
}

const points = [point(1, Infinity, 5), point(0.7, 40, 4), point(0.5, Infinity, 3), point(0.3, 50, 1)];

describe('the table of measured settings', () => {
  it('begins with the most exact, the faster first of those that are equal', () => {
    expect(sortedPoints(points, FIRST_ORDER)).toEqual([2, 0, 3, 1]);
  });

  it('is sorted by any column', () => {
    expect(sortedPoints(points, { by: 'psnr', isDescending: false })).toEqual([1, 3, 2, 0]);
    expect(sortedPoints(points, { by: 'time', isDescending: false })).toEqual([3, 2, 1, 0]);
    expect(sortedPoints(points, { by: 'time', isDescending: true })).toEqual([0, 1, 2, 3]);
    expect(sortedPoints(points, { by: 'name', isDescending: false })).toEqual([3, 2, 1, 0]);
  });

  it('begins with the best of a column, and turns around the next time', () => {
    const byTime = orderAfter(FIRST_ORDER, 'time');
    expect(byTime).toEqual({ by: 'time', isDescending: false });
    expect(orderAfter(byTime, 'time')).toEqual({ by: 'time', isDescending: true });
    expect(orderAfter(byTime, 'psnr')).toEqual(FIRST_ORDER);
  });
});
