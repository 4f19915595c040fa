import {
  type FixedDetail,
  type FrameStatistics,
  isPlausible,
  type RasterizerReport,
  type StageTimings,
} from '@websplatter/core';
import type { ViewerState } from '../state/store.ts';
import { describeDetail } from '../ui/detail-words.ts';
import { formatBytes, formatCount, formatMs, formatRate, UNKNOWN } from '../ui/format.ts';

/** Texts by the names of figures. Empty ones do not apply. */
export type Figures = Readonly<Record<string, string>>;

/** The state as text; without the right side where there is none. */
export function hudText(state: ViewerState): Figures {
  const { statistics, frameRate, scene, isIdle, widthPx, heightPx, adapterLabel } = state;
  const { comparison, drawnDetail, streaming } = state;
  const isSplit = comparison?.kind === 'split';
  // A lone frame has no pace, and a slow drag is a row of them: its own time is the next best.
  const frameMs = frameRate?.frameMs ?? statistics?.timing.wallClockMs;
  const rate = isIdle || frameMs === undefined ? undefined : 1000 / frameMs;
  return {
    frameMs: formatMs(frameMs ?? Number.NaN),
    rate: rate === undefined ? '' : formatRate(rate),
    // Nothing is drawn while nothing changes: a rate would be wrong.
    rateUnit: rate === undefined ? (isIdle ? 'idle' : '') : 'fps',
    ...stageFigures(statistics, state.rasterizer),
    ...(isSplit && figuresOf('right', stageFigures(state.rightStatistics, state.rightRasterizer))),
    loaded: formatCount(scene?.splats ?? Number.NaN),
    // The labels of a split image name it for each side.
    detail: isSplit ? '' : detailText(drawnDetail, statistics?.cutErrorPx ?? null),
    ...streamFigures(streaming),
    resolution: widthPx > 0 ? `${widthPx} × ${heightPx}` : UNKNOWN,
    adapter: adapterLabel || UNKNOWN,
  };
}

function stageFigures(statistics: FrameStatistics | null, rasterizer: RasterizerReport | null): Figures {
  const timing = statistics?.timing;
  return {
    preprocess: formatMs(timing?.preprocessMs ?? Number.NaN),
    sort: formatMs(timing?.sortMs ?? Number.NaN),
    rasterize: formatMs(timing?.rasterizeMs ?? Number.NaN),
    rest: formatMs(restMs(timing)),
    total: formatMs(timing?.totalMs ?? Number.NaN),
    source: timing ? sourceText(timing) : '',
    rasterizer: statistics?.rasterizer ?? UNKNOWN,
    otherRasterizer: statistics && rasterizer ? otherRasterizer(statistics, rasterizer) : '',
    rasterizerReason: statistics && rasterizer ? rasterizerReason(statistics, rasterizer) : '',
    visible: formatCount(statistics?.visibleSplats ?? Number.NaN),
  };
}

/** Empty where nothing streams. */
function streamFigures(streaming: ViewerState['streaming']): Figures {
  if (!streaming) return { bricks: '', fetched: '' };
  const { residentBricks, bricks, missingBricks, fetchedBytes, bytesPerSecond } = streaming;
  const missing = missingBricks > 0 ? `, ${formatCount(missingBricks)} missing` : '';
  const rate = bytesPerSecond > 0 ? `, ${formatBytes(bytesPerSecond)}/s` : '';
  return {
    bricks: `${formatCount(residentBricks)} of ${formatCount(bricks)}${missing}`,
    fetched: `${formatBytes(fetchedBytes)}${rate}`,
  };
}

/** With the error that a budget led to. */
function detailText(detail: FixedDetail, cutErrorPx: number | null): string {
  const words = describeDetail(detail);
  const hasBudget = detail !== 'full' && (detail.maxSplats || detail.maxShare);
  return hasBudget && cutErrorPx ? `${words} (${cutErrorPx.toPrecision(2)} px)` : words;
}

/** Figures by names that begin with what they are of: `right.sort`. */
export function figuresOf(subject: string, figures: Figures): Figures {
  return Object.fromEntries(Object.entries(figures).map(([name, text]) => [`${subject}.${name}`, text]));
}

function sourceText(timing: StageTimings): string {
  if (timing.source === 'wall-clock') return 'wall clock';
  return isPlausible(timing)
    ? 'GPU timestamps'
    : `GPU timestamps; the clock says ${formatMs(timing.wallClockMs)} ms`;
}

/**
 * `(quads 22.0 ms)`: the rasteriser that did not draw the frame; empty while its time is unknown.
 * The stage has the time of the other.
 */
function otherRasterizer({ rasterizer }: FrameStatistics, { tilesMs, quadsMs }: RasterizerReport): string {
  const [other, otherMs] = rasterizer === 'tiles' ? ['quads', quadsMs] : ['tiles', tilesMs];
  return otherMs === null ? '' : `(${other} ${formatMs(otherMs)} ms)`;
}

/** Why the frame was drawn by its rasteriser, or why the next one will be drawn by the other. */
function rasterizerReason({ rasterizer, tilePairs }: FrameStatistics, report: RasterizerReport): string {
  if (rasterizer === report.rasterizer) return capitalized(report.reason);
  if (rasterizer === 'quads' && tilePairs !== null)
    return 'This frame had no room for the lists of its tiles';
  return `${capitalized(report.rasterizer)} are next: ${report.reason}`;
}

function capitalized(text: string): string {
  return text.charAt(0).toUpperCase() + text.slice(1);
}

/** Time of a frame between its stages, ms; NaN if unknown. */
export function restMs(timing: StageTimings | undefined): number {
  if (!timing) return Number.NaN;
  const { totalMs, preprocessMs, sortMs, rasterizeMs } = timing;
  // `max` of NaN is NaN.
  return Math.max(0, totalMs - preprocessMs - sortMs - rasterizeMs);
}

/** Each stage's part of the frame's time, and that of the rest, 0…1; all 0 if not measured. */
export function stageShares(
  statistics: FrameStatistics | null,
): Record<'preprocess' | 'sort' | 'rasterize' | 'rest', number> {
  const timing = statistics?.timing;
  const rest = restMs(timing);
  const sum = timing ? timing.preprocessMs + timing.sortMs + timing.rasterizeMs + rest : Number.NaN;
  if (!timing || !(sum > 0)) return { preprocess: 0, sort: 0, rasterize: 0, rest: 0 };
  return {
    preprocess: timing.preprocessMs / sum,
    sort: timing.sortMs / sum,
    rasterize: timing.rasterizeMs / sum,
    rest: rest / sum,
  };
}
