import { resolveAccuracy } from '@websplatter/core';
import type { AccuracyPoint } from '@websplatter/core/measure';
import { describe, expect, it } from 'vitest';
import { formatDb } from '../ui/format.ts';
import { chartLayout, placeLabels, ticksIn } from './chart-layout.ts';

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

const AREA = { left: 0, top: 0, width: 200, height: 100 };
const size = { width: 40, height: 12 };

describe('names of points', () => {
  it('stand to the right where there is room', () => {
    expect(placeLabels([{ x: 50, y: 50, ...size }], AREA)).toEqual([{ left: 58, top: 44, ...size }]);
  });

  it('move to the left at the right edge, and below at the top', () => {
    const [atRight] = placeLabels([{ x: 190, y: 50, ...size }], AREA);
    expect(atRight).toEqual({ left: 142, top: 44, ...size });
    const [wide] = placeLabels([{ x: 100, y: 5, width: 120, height: 12 }], AREA);
    expect(wide).toEqual({ left: 40, top: 13, width: 120, height: 12 });
  });

  it('stand beside a line rather than on it, and on it rather than nowhere', () => {
    const point = { x: 50, y: 50, ...size };
    const across = { left: 0, top: 49, width: 200, height: 2 };
    expect(placeLabels([point], AREA, [across])).toEqual([{ left: 30, top: 30, ...size }]);
    expect(placeLabels([point], AREA, [AREA])).toEqual(placeLabels([point], AREA));
  });

  it('cover neither one another nor a point, and give way in order', () => {
    const crowd = Array.from({ length: 12 }, (_, i) => ({ x: 60 + i, y: 50 + i, ...size }));
    const boxes = placeLabels(crowd, AREA);
    expect(boxes[0]).not.toBeNull();
    expect(boxes).toContain(null);
    const placed = boxes.filter((box) => box !== null);
    for (const [i, a] of placed.entries()) {
      for (const b of placed.slice(i + 1)) {
        const apartX = a.left + a.width <= b.left || b.left + b.width <= a.left;
        const apartY = a.top + a.height <= b.top || b.top + b.height <= a.top;
        expect(apartX || apartY).toBe(true);
      }
    }
    for (const [i, box] of boxes.entries()) {
      if (!box) continue;
      for (const [j, { x, y }] of crowd.entries()) {
        if (i === j) continue;
        const isCovered = x > box.left && x < box.left + box.width && y > box.top && y < box.top + box.height;
        expect(isCovered).toBe(false);
      }
    }
  });
});

const textsIn = (from: number, to: number, most: number) => ticksIn([from, to], most).map(({ text }) => text);

describe('ticks of an axis', () => {
  it('are round values at steps of 1, 2 or 5, lowest first', () => {
    expect(textsIn(3, 11, 8)).toEqual(['3', '4', '5', '6', '7', '8', '9', '10', '11']);
    expect(textsIn(3, 11, 4)).toEqual(['4', '6', '8', '10']);
    expect(textsIn(18, 57, 9)).toEqual(['20', '25', '30', '35', '40', '45', '50', '55']);
    expect(textsIn(0, 7, 1)).toEqual(['0']);
    expect(textsIn(80, 1150, 3)).toEqual(['500', '1000']);
  });

  it('have as many decimals as the step needs', () => {
    expect(textsIn(0.02, 0.31, 3)).toEqual(['0.1', '0.2', '0.3']);
    expect(textsIn(0.91, 1.02, 6)).toEqual(['0.92', '0.94', '0.96', '0.98', '1.00', '1.02']);
    expect(textsIn(0, 0.0009, 1)).toEqual(['0.000']);
  });

  it('lie within the range, no more than were asked for and one', () => {
    for (const [from, to] of [
      [0, 1],
      [0.07, 0.0701],
      [99.9, 1200],
      [1e-6, 3e-6],
    ] as const) {
      for (let most = 1; most < 12; most++) {
        const values = ticksIn([from, to], most).map(({ value }) => value);
        expect(values.length).toBeLessThanOrEqual(most + 1);
        for (const value of values)
          expect(value >= from * (1 - 1e-12) && value <= to * (1 + 1e-12)).toBe(true);
      }
    }
  });
});
