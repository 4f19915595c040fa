import type { SplatEngine } from '@websplatter/core';
import type { ViewerState, ViewerStore } from '../state/store.ts';
import { summarize, type TimeSummary } from '../state/time-summary.ts';
import type { FrameRecorder, Side } from './frame-recorder.ts';
import { HistoryChart } from './history-chart.ts';
import { hudText, stageShares } from './hud-figures.ts';
import { cpuFigures, memoryFigures, sideFigures } from './large-figures.ts';

/** Figures that change faster than this cannot be read. */
export const LEAST_PAUSE_MS = 120;
/** Slower figures would seem to stand still. */
const MOST_PAUSE_MS = 1000;
/** CPU time that figures may take of each frame. */
export const FIGURES_BUDGET_MS = 0.2;

/**
 * Time from one write of figures to the next: so long that, shared out among the frames between, a
 * write takes no more than the budget.
 *
 * @param writeMs CPU time of a write.
 * @param frameMs time from one frame to the next.
 */
export function pauseBetweenWrites(writeMs: number, frameMs: number): number {
  const pauseMs = (writeMs / FIGURES_BUDGET_MS) * frameMs;
  return Math.min(MOST_PAUSE_MS, Math.max(LEAST_PAUSE_MS, pauseMs));
}

/** Of the newest write in the smoothed time of writes. */
const NEWEST_WEIGHT = 0.2;
/** Memory changes seldom, and listing it takes longer than all other figures. */
const MEMORY_INTERVAL_MS = 1000;

/** State that figures follow from. Other state changes more often, such as a dragged camera. */
const TOLD: readonly (keyof ViewerState)[] = [
  'statistics',
  'rasterizer',
  'rightStatistics',
  'rightRasterizer',
  'frameRate',
  'isIdle',
  'scene',
  'widthPx',
  'heightPx',
  'adapterLabel',
  'accuracy',
  'comparison',
  'drawnDetail',
  'streaming',
];

export interface HudSources {
  readonly store: ViewerStore;
  readonly recorder: FrameRecorder;
  /** Whose memory is shown; null while there is no GPU. */
  readonly engine: () => SplatEngine | null;
}

/**
 * Writes the figures into the elements of `root`, outside React and slowly enough to be read.
 * Returns a function that stops this.
 *
 * - `data-figure="NAME"` gets a text.
 * - `data-title="NAME"` gets a title.
 * - `data-row="NAME NAME"` is hidden while those figures are empty.
 * - `data-share="NAME"` grows with a part of its parent's width.
 * - `data-history="SIDE"`, a canvas, gets a chart of the last frames.
 */
export function bindHud(root: HTMLElement, sources: HudSources): () => void {
  const { store, recorder } = sources;
  const binding = new HudBinding(root, sources, () => request());
  let timer: ReturnType<typeof setTimeout> | undefined;
  let writtenMs = Number.NEGATIVE_INFINITY;
  let pauseMs = LEAST_PAUSE_MS;
  /** Smoothed, since a busy machine makes single writes long. */
  let writeMs = 0;
  const write = () => {
    clearTimeout(timer);
    timer = undefined;
    writtenMs = performance.now();
    binding.write(writtenMs);
    const elapsedMs = performance.now() - writtenMs;
    recorder.spend(elapsedMs);
    writeMs += NEWEST_WEIGHT * (elapsedMs - writeMs);
    pauseMs = pauseBetweenWrites(writeMs, recorder.frameMs);
  };
  const request = (afterMs = pauseMs) => {
    timer ??= setTimeout(write, Math.max(0, writtenMs + afterMs - performance.now()));
  };
  write();
  const unsubscribe = store.subscribe((state, before) => {
    if (state.isHudFrozen !== before.isHudFrozen) write();
    if (state.isHudFrozen || TOLD.every((name) => state[name] === before[name])) return;
    // The last figures stay on the screen: they are not to come late.
    if (state.isIdle && !before.isIdle) {
      clearTimeout(timer);
      timer = undefined;
    }
    request(state.isIdle ? LEAST_PAUSE_MS : pauseMs);
  });
  return () => {
    unsubscribe();
    clearTimeout(timer);
    binding.destroy();
  };
}

const NOTHING = summarize([]);

class HudBinding {
  readonly #sources: HudSources;
  readonly #figures: readonly { readonly name: string; readonly text: Text }[];
  readonly #titled: readonly HTMLElement[];
  readonly #rows: readonly HTMLElement[];
  readonly #bars: readonly { readonly name: string; readonly element: HTMLElement; share: number }[];
  readonly #charts: readonly { readonly side: Side; readonly chart: HistoryChart }[];
  #paintedRevision = -1;
  #summaries: Partial<Record<Side, TimeSummary>> = {};
  #memory = memoryFigures(null, Number.NaN);
  #memoryMs = Number.NEGATIVE_INFINITY;

  constructor(root: HTMLElement, sources: HudSources, onStale: () => void) {
    this.#sources = sources;
    const all = (name: string) => [...root.querySelectorAll<HTMLElement>(`[data-${name}]`)];
    this.#figures = all('figure').map((element) => {
      const text = document.createTextNode('');
      element.replaceChildren(text);
      return { name: element.dataset.figure ?? '', text };
    });
    this.#titled = all('title');
    this.#rows = all('row');
    this.#bars = all('share').map((element) => ({
      name: element.dataset.share ?? '',
      element,
      share: Number.NaN,
    }));
    this.#charts = all('history').map((element) => ({
      side: element.dataset.history as Side,
      chart: new HistoryChart(element as HTMLCanvasElement, root, onStale),
    }));
  }

  write(nowMs: number): void {
    const { recorder } = this.#sources;
    const state = recorder.shown;
    const shares: Record<string, number> = stageShares(state.statistics);
    const right = Object.entries(stageShares(state.rightStatistics));
    for (const [stage, share] of right) shares[`right.${stage}`] = share;
    const texts: Record<string, string | undefined> = hudText(state);
    // The chart is part of the largest size alone.
    if (this.#charts.length > 0) {
      this.#paint();
      Object.assign(texts, this.#largeTexts(nowMs));
      for (const [group, bytes] of Object.entries(this.#memory.bytes)) shares[`memory.${group}`] = bytes;
    }
    this.#writeTexts(texts);
    this.#writeShares(shares);
  }

  destroy(): void {
    for (const { chart } of this.#charts) chart.destroy();
    for (const { text } of this.#figures) text.remove();
  }

  #largeTexts(nowMs: number): Record<string, string | undefined> {
    const { recorder, engine } = this.#sources;
    const state = recorder.shown;
    if (!state.isHudFrozen && nowMs - this.#memoryMs >= MEMORY_INTERVAL_MS) {
      const current = engine();
      this.#memory = memoryFigures(
        current?.memory() ?? null,
        current?.device.limits.maxBufferSize ?? Number.NaN,
      );
      this.#memoryMs = nowMs;
    }
    const sides = this.#charts.map(({ side }) => sideFigures(side, state, this.#summaries[side] ?? NOTHING));
    return {
      ...sides[0],
      ...sides[1],
      ...cpuFigures(summarize(recorder.renderMs), summarize(recorder.ownMs)),
      ...this.#memory.texts,
    };
  }

  #paint(): void {
    const { recorder } = this.#sources;
    const { revision } = recorder;
    for (const { side, chart } of this.#charts) {
      if (revision === this.#paintedRevision && !chart.isStale) continue;
      this.#summaries[side] = chart.paint(recorder.frames(side).map(({ timing }) => timing));
    }
    this.#paintedRevision = revision;
  }

  #writeTexts(texts: Readonly<Record<string, string | undefined>>): void {
    for (const { name, text } of this.#figures) {
      const words = texts[name] ?? '';
      if (text.data !== words) text.data = words;
    }
    for (const element of this.#titled) {
      const title = texts[element.dataset.title ?? ''] ?? '';
      if (element.title !== title) element.title = title;
    }
    for (const row of this.#rows) {
      const isEmpty = (row.dataset.row ?? '').split(' ').every((name) => !texts[name]);
      if (row.hidden !== isEmpty) row.hidden = isEmpty;
    }
  }

  #writeShares(shares: Readonly<Record<string, number>>): void {
    for (const bar of this.#bars) {
      const share = shares[bar.name] ?? 0;
      if (bar.share === share) continue;
      bar.share = share;
      bar.element.hidden = share === 0;
      bar.element.style.flexGrow = String(share);
    }
  }
}
