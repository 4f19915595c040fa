import {
  type FrameStatistics,
  isPlausible,
  type RasterizerReport,
  type StageTimings,
} from '@websplatter/core';
import type { ViewerStore } from '../state/store.ts';
import type { ViewerState } from '../state/viewer-state.ts';
import { formatCount, formatMs, formatRate, UNKNOWN } from '../words/format.ts';

export type HudFigure =
  | 'frameMs'
  | 'rate'
  | 'rateUnit'
  | 'preprocess'
  | 'sort'
  | 'rasterize'
  | 'total'
  | 'source'
  | 'rasterizer'
  | 'otherRasterizer'
  | 'rasterizerReason'
  | 'visible'
  | 'loaded'
  | 'resolution'
  | 'adapter';

/** Figures that change faster than this cannot be read. */
const WRITE_INTERVAL_MS = 120;

/** The state as text. */
export function hudText(state: ViewerState): Record<HudFigure, string> {
  const { statistics, rasterizer, frameRate, scene, isIdle, widthPx, heightPx, adapterLabel } = state;
  const timing = statistics?.timing;
  // A lone frame has no pace, and a slow drag is a row of them: its own time is the next best.
  const frameMs = frameRate?.frameMs ?? timing?.wallClockMs;
  const rate = isIdle || frameMs === undefined ? undefined : 1000 / frameMs;
  return {
    frameMs: formatMs(frameMs ?? Number.NaN),
    rate: rate === undefined ? '' : formatRate(rate),
    // Nothing is drawn while nothing changes: a rate would be wrong.
    rateUnit: rate === undefined ? (isIdle ? 'idle' : '') : 'fps',
    preprocess: formatMs(timing?.preprocessMs ?? Number.NaN),
    sort: formatMs(timing?.sortMs ?? Number.NaN),
    rasterize: formatMs(timing?.rasterizeMs ?? Number.NaN),
    total: formatMs(timing?.totalMs ?? Number.NaN),
    source: timing ? sourceText(timing) : '',
    rasterizer: statistics?.rasterizer ?? UNKNOWN,
    otherRasterizer: statistics && rasterizer ? otherRasterizer(statistics, rasterizer) : '',
    rasterizerReason: statistics && rasterizer ? rasterizerReason(statistics, rasterizer) : '',
    visible: formatCount(statistics?.visibleSplats ?? Number.NaN),
    loaded: formatCount(scene?.splats ?? Number.NaN),
    resolution: widthPx > 0 ? `${widthPx} × ${heightPx}` : UNKNOWN,
    adapter: adapterLabel || UNKNOWN,
  };
}

function sourceText(timing: StageTimings): string {
  if (timing.source === 'wall-clock') return 'wall clock';
  return isPlausible(timing)
    ? 'GPU timestamps'
    : `GPU timestamps; the clock says ${formatMs(timing.wallClockMs)} ms`;
}

/** `(quads 22.0 ms)`: what did not draw the frame; empty while its time is unknown. The time of what did is the stage's. */
function otherRasterizer({ rasterizer }: FrameStatistics, { tilesMs, quadsMs }: RasterizerReport): string {
  const [other, otherMs] = rasterizer === 'tiles' ? ['quads', quadsMs] : ['tiles', tilesMs];
  return otherMs === null ? '' : `(${other} ${formatMs(otherMs)} ms)`;
}

/** Why the frame was drawn by what drew it; where the next one will be drawn by the other, why that is so. */
function rasterizerReason({ rasterizer, tilePairs }: FrameStatistics, report: RasterizerReport): string {
  if (rasterizer === report.rasterizer) return capitalized(report.reason);
  if (rasterizer === 'quads' && tilePairs !== null) return 'The lists of the tiles had no room in this frame';
  return `${capitalized(report.rasterizer)} are next: ${report.reason}`;
}

function capitalized(text: string): string {
  return text.charAt(0).toUpperCase() + text.slice(1);
}

/** Each stage's part of the time of all three, 0…1; all 0 if they are not measured. */
export function stageShares({
  statistics,
}: ViewerState): Record<'preprocess' | 'sort' | 'rasterize', number> {
  const timing = statistics?.timing;
  const sum = timing ? timing.preprocessMs + timing.sortMs + timing.rasterizeMs : Number.NaN;
  if (!timing || !(sum > 0)) return { preprocess: 0, sort: 0, rasterize: 0 };
  return {
    preprocess: timing.preprocessMs / sum,
    sort: timing.sortMs / sum,
    rasterize: timing.rasterizeMs / sum,
  };
}

/**
 * Writes the store's figures into the elements of `root` that carry `data-figure`, `data-title` and `data-share`, outside
 * React and slowly enough to be read. Returns what stops that.
 */
export function bindHud(root: HTMLElement, store: ViewerStore): () => void {
  const figures = [...root.querySelectorAll<HTMLElement>('[data-figure]')].map((element) => {
    const text = document.createTextNode('');
    element.replaceChildren(text);
    return { name: element.dataset.figure as HudFigure, text };
  });
  const titled = [...root.querySelectorAll<HTMLElement>('[data-title]')];
  const bars = [...root.querySelectorAll<HTMLElement>('[data-share]')];
  let timer: ReturnType<typeof setTimeout> | null = null;
  let writtenMs = Number.NEGATIVE_INFINITY;

  const write = () => {
    timer = null;
    writtenMs = performance.now();
    const state = store.getState();
    const texts = hudText(state);
    for (const { name, text } of figures) {
      if (text.data !== texts[name]) text.data = texts[name];
    }
    for (const element of titled) {
      const title = texts[element.dataset.title as HudFigure];
      if (element.title !== title) element.title = title;
    }
    const shares: Record<string, number> = stageShares(state);
    for (const bar of bars) {
      const share = shares[bar.dataset.share ?? ''];
      bar.hidden = share === 0;
      bar.style.flexGrow = String(share);
    }
  };
  write();
  const unsubscribe = store.subscribe(() => {
    timer ??= setTimeout(write, Math.max(0, writtenMs + WRITE_INTERVAL_MS - performance.now()));
  });
  return () => {
    unsubscribe();
    if (timer !== null) clearTimeout(timer);
    for (const { text } of figures) text.remove();
  };
}
