import type { AccuracyPoint } from '@websplatter/core/measure';
import { describe, expect, it } from 'vitest';
import { errorTimeChart, frontPath, ticksIn } from './error-time-chart.ts';

const AREA = { left: 10, top: 20, right: 210, bottom: 120 };

function point(name: string, psnrDb: number, ms: number, isOnFront = false): AccuracyPoint {
  const total = { median: ms, low: 0.9 * ms, high: 1.1 * ms, p99: 1.2 * ms };
  return { name, error: { psnrDb }, timeMs: { total }, isOnFront } as AccuracyPoint;
}

const chartOf = (points: readonly AccuracyPoint[]) => errorTimeChart(points, AREA, { x: 4, y: 4 });

const POINTS = [
  point('reference', Number.POSITIVE_INFINITY, 4, true),
  point('balanced', 50, 2, true),
  point('alphaCutoff 1/64', 30, 3),
];

describe('error over time', () => {
  it('orders points by time and knows their places in the table', () => {
    const { points } = chartOf(POINTS);
    expect(points.map(({ point: { name }, index }) => [name, index])).toEqual([
      ['balanced', 1],
      ['alphaCutoff 1/64', 2],
      ['reference', 0],
    ]);
  });

  it('has the front as a line from its fastest point up to its most exact, and on to the end', () => {
    const { front, points } = chartOf(POINTS);
    const [balanced, , exact] = points;
    expect(front).toEqual([
      { x: balanced.x, y: AREA.bottom },
      { x: balanced.x, y: balanced.y },
      { x: exact.x, y: exact.y },
      { x: AREA.right, y: exact.y },
    ]);
    expect(frontPath(front, Math.round)).toMatch(/^M\d+ 120H\d+V\d+H\d+V\d+H210V\d+$/);
    expect(chartOf([]).front).toEqual([]);
  });

  it('puts what equals the reference into a band above everything else', () => {
    const { points, bandBottom, yTicks } = chartOf(POINTS);
    const [balanced, , exact] = points;
    expect(bandBottom).toBeLessThan(balanced.y);
    expect(exact.y).toBeCloseTo((AREA.top + bandBottom!) / 2, 9);
    expect(yTicks.every(({ at }) => at > bandBottom!)).toBe(true);
    expect(chartOf(POINTS.slice(1)).bandBottom).toBeNull();
  });

  it('has all points with their intervals inside, and room around them', () => {
    for (const points of [POINTS, [point('a', 40, 0.01), point('b', 41, 9)], [point('one', 40, 2)]]) {
      for (const { x, y, lowX, highX } of chartOf(points).points) {
        expect(AREA.left < lowX && lowX < x && x < highX && highX < AREA.right).toBe(true);
        expect(AREA.top < y && y < AREA.bottom).toBe(true);
      }
    }
  });

  it('has a logarithmic axis if times differ much', () => {
    expect(chartOf(POINTS).isLogTime).toBe(false);
    expect(chartOf(POINTS).xTicks.map(({ text }) => text)).toEqual(['2', '3', '4']);
    const wide = chartOf([point('a', 40, 0.5), point('b', 41, 9)]);
    expect(wide.isLogTime).toBe(true);
    expect(wide.xTicks.map(({ text }) => text)).toEqual(['0.5', '1', '2', '5', '10']);
    const wider = chartOf([point('a', 40, 0.05), point('b', 41, 90)]);
    expect(wider.xTicks.map(({ text }) => text)).toEqual(['0.1', '1', '10', '100']);
  });

  it.each([[[]], [[point('one', 40, 2)]], [[point('exact', Number.POSITIVE_INFINITY, 2)]]])(
    'has finite places for any number of points',
    (some) => {
      const { points, xTicks, yTicks } = chartOf(some);
      for (const { x, y } of points) expect(Number.isFinite(x) && Number.isFinite(y)).toBe(true);
      for (const { at } of [...xTicks, ...yTicks]) expect(Number.isFinite(at)).toBe(true);
    },
  );
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
