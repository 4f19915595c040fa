import type { StageTimings } from '@websplatter/core';
import fc from 'fast-check';
import { describe, expect, it } from 'vitest';
import { CHART_LAYERS, historyLayout } from './history-layout.ts';

const AREA = { widthPx: 300, heightPx: 100, capacity: 300 };

const frame = (preprocessMs: number, sortMs: number, rasterizeMs: number, restMs = 0): StageTimings => {
  const totalMs = preprocessMs + sortMs + rasterizeMs + restMs;
  return {
    source: 'gpu-timestamps',
    preprocessMs,
    sortMs,
    rasterizeMs,
    totalMs,
    wallClockMs: totalMs,
    passMs: {},
  };
};

describe('the chart of the last frames', () => {
  it('piles each stage on the one before, the newest frame at the right edge', () => {
    const { topMs, rects } = historyLayout([frame(2, 4, 6), frame(4, 4, 8, 2)], AREA);
    expect(topMs).toBe(50);
    expect(rects).toEqual({
      preprocess: [298, 96, 1, 4, 299, 92, 1, 8],
      sort: [298, 88, 1, 8, 299, 84, 1, 8],
      rasterize: [298, 76, 1, 12, 299, 68, 1, 16],
      rest: [299, 64, 1, 4],
    });
  });

  it('shows whole frames where only their times are known', () => {
    const wallClock: StageTimings = {
      ...frame(0, 0, 0),
      source: 'wall-clock',
      preprocessMs: Number.NaN,
      sortMs: Number.NaN,
      rasterizeMs: Number.NaN,
      totalMs: 10,
    };
    expect(historyLayout([wallClock], AREA).rects).toEqual({
      preprocess: [],
      sort: [],
      rasterize: [],
      rest: [299, 50, 1, 50],
    });
  });

  it('cuts single peaks off rather than flatten all other frames, and says which', () => {
    const frames = Array.from({ length: 200 }, (_, i) => frame(1, 1, i === 198 ? 500 : 3));
    const layout = historyLayout(frames, AREA);
    expect(layout.topMs).toBe(20);
    expect(layout.cut).toEqual([298]);
  });

  it('draws the budget of 60 frames a second, unless all frames lie far below it', () => {
    expect(historyLayout([frame(1, 1, 2)], AREA)).toMatchObject({ topMs: 20, budgetPx: 17 });
    expect(historyLayout([frame(0.1, 0.1, 0.3)], AREA)).toMatchObject({ topMs: 1, budgetPx: null });
    expect(historyLayout([frame(100, 100, 300)], AREA)).toMatchObject({ topMs: 1000, budgetPx: 98 });
    expect(historyLayout([], AREA)).toMatchObject({ topMs: 20, medianPx: null, p99Px: null });
  });

  it('leaves the oldest frames out where pixels lack, and widens bars where there are more', () => {
    const frames = Array.from({ length: 300 }, () => frame(1, 1, 1));
    expect(historyLayout(frames, { ...AREA, widthPx: 240 }).rects.sort.length / 4).toBe(240);
    const wide = historyLayout(frames, { ...AREA, widthPx: 750 });
    expect(wide.barWidthPx).toBe(2);
    expect(wide.rects.sort[0]).toBe(150);
  });

  it('never leaves its area and never lets bars overlap', () => {
    const ms = fc.double({ min: 0, max: 1e4, noNaN: true });
    fc.assert(
      fc.property(fc.array(fc.tuple(ms, ms, ms, ms), { maxLength: 40 }), (times) => {
        const layout = historyLayout(
          times.map((each) => frame(...each)),
          { widthPx: 40, heightPx: 50, capacity: 40 },
        );
        const covered = new Set<string>();
        for (const layer of CHART_LAYERS) {
          const rects = layout.rects[layer];
          for (let i = 0; i < rects.length; i += 4) {
            const [x, y, width, height] = rects.slice(i, i + 4);
            expect(x >= 0 && x + width <= 40 && y >= 0 && y + height <= 50).toBe(true);
            for (let row = y; row < y + height; row++) {
              expect(covered.has(`${x} ${row}`)).toBe(false);
              covered.add(`${x} ${row}`);
            }
          }
        }
      }),
    );
  });
});
