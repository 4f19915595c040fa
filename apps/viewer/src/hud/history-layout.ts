import type { StageTimings } from '@websplatter/core';
import { roundAbove } from '@websplatter/kit/nice-steps';
import { summarize } from '../state/time-summary.ts';
import { restMs } from './hud-figures.ts';

/** The layers of a bar, from the bottom up; `rest` is the time besides the stages, or all of it. */
export const CHART_LAYERS = ['preprocess', 'sort', 'rasterize', 'rest'] as const;
export type ChartLayer = (typeof CHART_LAYERS)[number];

/** Time of a frame on a screen with 60 refreshes a second. */
export const FRAME_BUDGET_MS = 1000 / 60;

/** A budget further above the slow frames than this would make them too flat to be read. */
const MOST_BUDGET_HEADROOM = 8;
/** Part of the height that is left above the slow frames, or above the budget. */
const HEADROOM = 1.15;
/** Times may be 0. */
const LEAST_TOP_MS = 0.01;

export interface HistoryLayout {
  /** Time at the top edge. */
  readonly topMs: number;
  /** Per layer its rectangles: x, y, width and height of each, in pixels, y down. */
  readonly rects: Readonly<Record<ChartLayer, readonly number[]>>;
  /** Left edges of bars that go beyond the top. */
  readonly cut: readonly number[];
  readonly barWidthPx: number;
  /** Heights of lines; null where they lie beyond the top, or nothing is known. */
  readonly medianPx: number | null;
  readonly p99Px: number | null;
  readonly budgetPx: number | null;
}

/**
 * A bar for each frame, the newest at the right edge; the oldest are left out if they have no
 * pixel.
 *
 * @param frames oldest first.
 * @param capacity how many frames the width is for.
 */
export function historyLayout(
  frames: readonly StageTimings[],
  { widthPx, heightPx, capacity }: { widthPx: number; heightPx: number; capacity: number },
): HistoryLayout {
  const summary = summarize(frames.map(({ totalMs }) => totalMs));
  const topMs = topOf(summary.p99);
  const barWidthPx = Math.max(1, Math.floor(widthPx / capacity));
  const shown = frames.slice(-Math.floor(widthPx / barWidthPx));
  const yOf = (ms: number) => heightPx - Math.round((Math.min(ms, topMs) / topMs) * heightPx);
  const lineAt = (ms: number) => (ms <= topMs ? yOf(ms) : null);
  const rects: Record<ChartLayer, number[]> = { preprocess: [], sort: [], rasterize: [], rest: [] };
  const cut: number[] = [];
  shown.forEach((timing, i) => {
    const x = widthPx - (shown.length - i) * barWidthPx;
    if (timing.totalMs > topMs) cut.push(x);
    let untilMs = 0;
    for (const [layer, layerMs] of layersOf(timing)) {
      const bottom = yOf(untilMs);
      untilMs += layerMs;
      const top = yOf(untilMs);
      if (bottom > top) rects[layer].push(x, top, barWidthPx, bottom - top);
    }
  });
  return {
    topMs,
    rects,
    cut,
    barWidthPx,
    medianPx: lineAt(summary.median),
    p99Px: lineAt(summary.p99),
    budgetPx: lineAt(FRAME_BUDGET_MS),
  };
}

function layersOf(timing: StageTimings): readonly (readonly [ChartLayer, number])[] {
  const { source, preprocessMs, sortMs, rasterizeMs, totalMs } = timing;
  if (source === 'wall-clock') return [['rest', totalMs]];
  return [
    ['preprocess', preprocessMs],
    ['sort', sortMs],
    ['rasterize', rasterizeMs],
    ['rest', restMs(timing)],
  ];
}

/** A round time above the slow frames and, if not far above, the budget. Peaks may be cut off. */
function topOf(p99Ms: number): number {
  const slowMs = Number.isFinite(p99Ms) ? p99Ms : FRAME_BUDGET_MS;
  const showsBudget = slowMs * MOST_BUDGET_HEADROOM >= FRAME_BUDGET_MS;
  const leastMs = HEADROOM * (showsBudget ? Math.max(slowMs, FRAME_BUDGET_MS) : slowMs);
  return roundAbove(Math.max(leastMs, LEAST_TOP_MS));
}
