import { resolveAccuracy } from '@websplatter/core';
import type { AccuracyPoint } from '@websplatter/core/measure';
import { describe, expect, it } from 'vitest';
import { formatDb } from '../ui/format.ts';
import { chartLayout } from './chart-layout.ts';

function point(name: string, psnrDb: number, ms: number, isOnFront = false): AccuracyPoint {
  const spread = { median: ms, low: 0.9 * ms, high: 1.1 * ms, p99: 1.2 * ms };
  return {
    name,
    settings: resolveAccuracy(),
    changed: [],
    detail: 'full',
    splats: 0,
    filteredPsnrDb: null,
    error: { psnrDb, maxError: 0, p999Error: 0, ssim: 1 },
    timeMs: { preprocess: null, sort: null, rasterize: null, total: spread },
    rasterizers: ['quads'],
    isOnFront,
    bytes: 0,
    notes: [],
  };
}

describe('chart of accuracy', () => {
  const points = [
    point('reference', Number.POSITIVE_INFINITY, 4, true),
    point('balanced', 50, 2, true),
    point('alphaCutoff 1/64', 30, 3),
  ];

  it('orders points by time and knows their places in the table', () => {
    const { placed } = chartLayout(points);
    expect(placed.map(({ name, index }) => [name, index])).toEqual([
      ['balanced', 1],
      ['alphaCutoff 1/64', 2],
      ['reference', 0],
    ]);
  });

  it('has the front as a line from its fastest point up to its most exact, and on to the end', () => {
    const { frontLine, placed, xRange, yRange } = chartLayout(points);
    const exactDb = placed[2].yDb;
    expect(frontLine.map(({ xMs, yDb }) => [xMs, yDb])).toEqual([
      [2, yRange[0]],
      [2, 50],
      [4, exactDb],
      [xRange[1], exactDb],
    ]);
    expect(chartLayout([]).frontLine).toEqual([]);
  });

  it('puts what equals the reference into a band above everything else, in sight', () => {
    const { placed, yRange, equalFromDb } = chartLayout(points);
    const exact = placed[2].yDb;
    expect(equalFromDb).toBeGreaterThan(50);
    expect(exact).toBeGreaterThan(equalFromDb ?? Infinity);
    expect(yRange[1]).toBeGreaterThan(exact);
    expect(yRange[1]).toBeLessThan(80);
    expect(placed[2].words).toBe('identical to the reference, 4.0 ms');
  });

  it('has no band where nothing equals the reference', () => {
    const { yRange, equalFromDb } = chartLayout(points.slice(1));
    expect(equalFromDb).toBeNull();
    expect(yRange[1]).toBeLessThan(55);
  });

  it('leaves room around all points, and never shows times before 0', () => {
    const { xRange, yRange } = chartLayout(points);
    expect(xRange[0]).toBeLessThan(2);
    expect(xRange[1]).toBeGreaterThan(4);
    expect(yRange[0]).toBeLessThan(30);
    const [low] = chartLayout([point('a', 40, 0.01), point('b', 41, 9)]).xRange;
    expect(low).toBe(0);
  });

  it.each([[[]], [[point('one', 40, 2)]], [[point('exact', Number.POSITIVE_INFINITY, 2)]]])(
    'has ranges for any number of points',
    (some) => {
      const { xRange, yRange } = chartLayout(some);
      for (const [low, high] of [xRange, yRange]) {
        expect(Number.isFinite(low) && Number.isFinite(high)).toBe(true);
        expect(high).toBeGreaterThan(low);
      }
    },
  );

  it('names presets first', () => {
    const { placed } = chartLayout(points);
    const byImportance = [...placed].sort((a, b) => b.importance - a.importance);
    expect(byImportance.map(({ name }) => name).at(-1)).toBe('alphaCutoff 1/64');
  });

  it('writes decibels', () => {
    expect(formatDb(48.26)).toBe('48.3');
    expect(formatDb(Number.POSITIVE_INFINITY)).toBe('identical');
  });
});
