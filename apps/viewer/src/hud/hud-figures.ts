import {
  type EngineMemory,
  type FrameStatistics,
  isPlausible,
  type RasterizerReport,
  type StageTimings,
  type TimedPass,
} from '@websplatter/core';
import {
  formatBytes,
  formatCount,
  formatMany,
  formatMs,
  formatRate,
  formatRough,
  UNKNOWN,
} from '@websplatter/kit/format';
import { type Drawn, sideDrawn } from '../state/accuracy.ts';
import { awaitsFirstParts } from '../state/frames.ts';
import { leftSplats } from '../state/left-splats.ts';
import type { ViewerState } from '../state/store.ts';
import { summarize } from '../state/time-summary.ts';
import { describeDetail } from '../ui/accuracy-words.ts';
import type { Side } from './frame-recorder.ts';

/** The large figure at the top, and what it measures. */
export interface Headline {
  /** A number, or a word without a unit. */
  readonly figure: string;
  readonly unit: string;
  readonly about: string;
}

/** In motion the frame rate; at rest, where a rate would be wrong, what the picture has cost. */
export function headline(state: ViewerState): Headline {
  const { statistics, rightStatistics, frameRate, isIdle, load, status, scene } = state;
  const isStarting = !statistics && (status === 'starting' || scene !== null);
  if (load || isStarting || awaitsFirstParts(state)) return { figure: 'Loading', unit: '', about: '' };
  if (!statistics) return { figure: UNKNOWN, unit: '', about: 'nothing drawn yet' };
  if (!isIdle && frameRate) {
    const { frameMs, framesPerSecond } = frameRate;
    const about = `${formatMs(frameMs)} ms from frame to frame`;
    return { figure: formatRate(framesPerSecond), unit: 'fps', about };
  }
  const totalMs = statistics.timing.totalMs + (rightStatistics?.timing.totalMs ?? 0);
  // A lone frame has no pace, and a slow drag is a row of them.
  return { figure: formatMs(totalMs), unit: 'ms', about: isIdle ? 'to draw, at rest' : 'to draw' };
}

/** Figures of the image as a whole. Empty ones do not apply. */
export function frameFigures(state: ViewerState) {
  const { statistics, scene, widthPx, heightPx, adapterLabel } = state;
  const { comparison, streaming } = state;
  return {
    loaded: formatCount((streaming ? statistics?.loadedSplats : scene?.splats) ?? Number.NaN),
    // Of a stream, not all is loaded.
    left: streaming ? '' : leftText(state),
    // The labels of a split image name it for each side.
    detail: comparison?.kind === 'split' ? '' : detailText(state, statistics?.cutErrorPx ?? null),
    ...streamFigures(streaming),
    resolution: widthPx > 0 ? `${widthPx} × ${heightPx}` : UNKNOWN,
    adapter: adapterLabel || UNKNOWN,
  };
}

/** Empty while nothing is removed, cropped away or hidden. */
function leftText(state: ViewerState): string {
  const left = leftSplats(state);
  const total = state.scene?.splats ?? 0;
  return left === null || left === total ? '' : formatCount(left);
}

export type StageFigures = ReturnType<typeof stageFigures>;

/** GPU times of one side's stages, as text. An image that is not split counts as the left side. */
export function stageFigures(side: Side, state: ViewerState) {
  const { statistics, rasterizer } = sideOf(side, state);
  const timing = statistics?.timing;
  return {
    preprocess: formatMs(timing?.preprocessMs ?? Number.NaN),
    sort: formatMs(timing?.sortMs ?? Number.NaN),
    rasterize: formatMs(timing?.rasterizeMs ?? Number.NaN),
    rest: formatMs(restMs(timing)),
    total: formatMs(timing?.totalMs ?? Number.NaN),
    totalLabel: timing?.source === 'wall-clock' ? 'Total' : 'Total on the GPU',
    source: timing ? sourceText(timing) : '',
    rasterizer: statistics?.rasterizer ?? UNKNOWN,
    otherRasterizer: statistics && rasterizer ? otherRasterizer(statistics, rasterizer) : '',
    rasterizerReason: statistics && rasterizer ? rasterizerReason(statistics, rasterizer) : '',
    candidates: formatCount(statistics?.candidateSplats ?? Number.NaN),
    visible: formatCount(statistics?.visibleSplats ?? Number.NaN),
  };
}

/** The last frame of one side. */
export function sideOf(side: Side, state: ViewerState) {
  return side === 'left'
    ? { statistics: state.statistics, rasterizer: state.rasterizer }
    : { statistics: state.rightStatistics, rasterizer: state.rightRasterizer };
}

/** Empty if nothing streams. */
function streamFigures(streaming: ViewerState['streaming']) {
  if (!streaming) return { bricks: '', fetched: '' };
  const { residentBricks, bricks, missingBricks, fetchedBytes, bytesPerSecond, error } = streaming;
  // Of the bricks that this view needs, not of all.
  const missing =
    missingBricks > 0 ? `, ${formatCount(missingBricks)} ${error ? 'not fetched' : 'on the way'}` : '';
  const rate = bytesPerSecond > 0 ? `, ${formatBytes(bytesPerSecond)}/s` : '';
  return {
    bricks: `${formatCount(residentBricks)} of ${formatCount(bricks)}${missing}`,
    fetched: `${formatBytes(fetchedBytes)}${rate}`,
  };
}

/** With the error that a budget led to. */
function detailText(
  { drawnDetail, movingScale, scene }: Pick<ViewerState, 'drawnDetail' | 'movingScale' | 'scene'>,
  cutErrorPx: number | null,
): string {
  const { maxSplats, maxShare }: { maxSplats?: number; maxShare?: number } = Object(drawnDetail);
  const words =
    maxSplats && scene
      ? `${formatMany(Math.min(maxSplats, scene.splats))} of ${formatMany(scene.splats)} splats`
      : describeDetail(drawnDetail);
  const isBudget = maxSplats !== undefined || maxShare !== undefined;
  const detail = isBudget && cutErrorPx ? `${words}, up to ${formatRough(cutErrorPx)} px off` : words;
  return [detail, movingScale < 1 ? 'half the resolution' : ''].filter(Boolean).join(', ');
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

/** Shares of the stages and of the rest in the frame's time, 0…1; all 0 if not measured. */
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

/** Passes by the stage that they belong to, with names for people. */
export const PASSES: readonly (readonly [TimedPass, string])[] = [
  ['preprocess', 'Cull, project, colour'],
  ['sort', 'Sort by depth'],
  ['tile-lists', 'List splats by tile'],
  ['tiles', 'Blend by tiles'],
  ['rasterize', 'Blend as quads'],
  ['upscale', 'Enlarge'],
  ['composite', 'Lay over background'],
  ['quads-sample', 'Sample of quads, to compare'],
];

/** Figures of one side that only the largest size shows. Empty ones have no row. */
export function sideFigures(side: Side, state: ViewerState, frames: readonly FrameStatistics[]) {
  const { statistics } = sideOf(side, state);
  const { sortKeyBits, resolutionScale } = drawnOf(side, state).accuracy;
  const { median, p99, peak } = summarize(frames.map(({ timing }) => timing.totalMs));
  return {
    passes: PASSES.map(([pass]) => passText(statistics?.timing.passMs[pass])),
    pairs: statistics?.tilePairs == null ? '' : formatCount(statistics.tilePairs),
    sortKeys: `${sortKeyBits} bits`,
    scale: `${Math.round(100 * resolutionScale * (side === 'left' ? state.movingScale : 1))} %`,
    median: formatMs(median),
    p99: formatMs(p99),
    peak: formatMs(peak),
  };
}

function passText(ms: number | undefined): string {
  return ms === undefined ? '' : formatMs(ms);
}

/** How one side of the image is drawn. */
export function drawnOf(side: Side, state: ViewerState): Drawn {
  const { comparison } = state;
  return comparison?.kind === 'split' ? sideDrawn(comparison[side], state) : state;
}

/** Median and 99th percentile of CPU times of frames, ms. */
export function cpuFigures(times: readonly number[]) {
  const { median, p99 } = summarize(times);
  return { median: formatMs(median), p99: formatMs(p99) };
}

/** Purposes of the GPU's memory. */
export const MEMORY_GROUPS = ['geometry', 'harmonics', 'bounds', 'frames', 'work'] as const;
type MemoryGroup = (typeof MEMORY_GROUPS)[number];

/** Bytes of each group; together they are `totalBytes`. */
export function memoryByGroup({ totalBytes, scene, frames }: EngineMemory): Record<MemoryGroup, number> {
  const sum = (bytes: readonly number[]) => bytes.reduce((before, each) => before + each, 0);
  const ofClouds = (bytesOf: (cloud: EngineMemory['scene']['clouds'][number]) => readonly number[]) =>
    sum(scene.clouds.flatMap(bytesOf));
  return {
    geometry: ofClouds(({ geometryBytes }) => Object.values(geometryBytes)),
    harmonics: ofClouds(({ shBytes }) => Object.values(shBytes)),
    bounds: ofClouds(({ chunksBytes }) => [chunksBytes]),
    frames: frames.totalBytes,
    work: totalBytes - scene.totalBytes - frames.totalBytes,
  };
}

/** GPU memory and its known limit: WebGPU tells the limit of one buffer, not of all. */
export function memoryFigures(memory: EngineMemory | null, maxBufferBytes: number) {
  if (!memory) return { total: UNKNOWN, peak: '', largest: '', limit: '' };
  const largest = memory.resources[0];
  return {
    total: formatBytes(memory.totalBytes),
    peak: formatBytes(memory.peakBytes),
    largest: largest ? `${formatBytes(largest.bytes)} (${largest.label})` : UNKNOWN,
    limit: formatBytes(maxBufferBytes),
  };
}
