import type { AccuracySettings, EngineMemory, FrameStatistics, TimedPass } from '@websplatter/core';
import { formatBytes, formatCount, formatMs, UNKNOWN } from '../formatting/format.ts';
import { sideAccuracy } from '../state/comparison.ts';
import type { ViewerState } from '../state/viewer-state.ts';
import type { Side } from './frame-recorder.ts';
import { type MemoryGroup, memoryByGroup } from './memory-groups.ts';
import { PASSES } from './pass-names.ts';
import type { TimeSummary } from './time-summary.ts';

type SideFigure =
  | 'candidates'
  | 'pairs'
  | 'sortKeys'
  | 'scale'
  | 'rest'
  | 'median'
  | 'p99'
  | 'peak'
  | `pass.${TimedPass}`;

export type LargeFigure =
  | `${Side}.${SideFigure}`
  | `memory.${MemoryGroup | 'total' | 'peak' | 'largest' | 'limit'}`
  | 'renderMedian'
  | 'renderP99'
  | 'ownMedian'
  | 'ownP99';

export type Figures<Name extends string> = Partial<Record<Name, string>>;

/** Figures of one side in the largest size. Empty ones do not apply, and have no row. */
export function sideFigures(side: Side, state: ViewerState, summary: TimeSummary): Figures<LargeFigure> {
  const statistics = side === 'left' ? state.statistics : state.rightStatistics;
  const { sortKeyBits, resolutionScale } = accuracyOf(side, state);
  const figures: Record<SideFigure, string> = {
    ...passFigures(statistics),
    candidates: formatCount(statistics?.candidateSplats ?? Number.NaN),
    pairs: statistics?.tilePairs == null ? '' : formatCount(statistics.tilePairs),
    sortKeys: `${sortKeyBits} bits`,
    scale: `${Math.round(100 * resolutionScale)} %`,
    rest: formatMs(restMs(statistics)),
    median: formatMs(summary.median),
    p99: formatMs(summary.p99),
    peak: formatMs(summary.peak),
  };
  return Object.fromEntries(Object.entries(figures).map(([name, text]) => [`${side}.${name}`, text]));
}

/** Time of a frame besides its stages; NaN if unknown. */
function restMs(statistics: FrameStatistics | null): number {
  if (!statistics) return Number.NaN;
  const { totalMs, preprocessMs, sortMs, rasterizeMs } = statistics.timing;
  // `max` of NaN is NaN.
  return Math.max(0, totalMs - preprocessMs - sortMs - rasterizeMs);
}

function passFigures(statistics: FrameStatistics | null): Record<`pass.${TimedPass}`, string> {
  const passMs = statistics?.timing.passMs ?? {};
  const texts = PASSES.map(([pass]) => [
    `pass.${pass}`,
    passMs[pass] === undefined ? '' : formatMs(passMs[pass]),
  ]);
  return Object.fromEntries(texts);
}

/** Settings that one side of the image is drawn with. */
export function accuracyOf(side: Side, { comparison, accuracy }: ViewerState): AccuracySettings {
  return comparison?.kind === 'split' ? sideAccuracy(comparison[side], accuracy) : accuracy;
}

/** CPU time of a frame: calls to the engine, and the figures themselves. */
export function cpuFigures(render: TimeSummary, own: TimeSummary): Figures<LargeFigure> {
  return {
    renderMedian: formatMs(render.median),
    renderP99: formatMs(render.p99),
    ownMedian: formatMs(own.median),
    ownP99: formatMs(own.p99),
  };
}

/** GPU memory by group, and its known limit: WebGPU tells that of one buffer, not of all. */
export function memoryFigures(
  memory: EngineMemory | null,
  maxBufferBytes: number,
): { readonly texts: Figures<LargeFigure>; readonly bytes: Readonly<Record<MemoryGroup, number>> } {
  if (!memory) {
    return {
      texts: { 'memory.total': UNKNOWN },
      bytes: { geometry: 0, harmonics: 0, bounds: 0, frames: 0, work: 0 },
    };
  }
  const bytes = memoryByGroup(memory);
  const groups = Object.entries(bytes).map(([group, held]) => [`memory.${group}`, formatBytes(held)]);
  const largest = memory.resources[0];
  const texts: Figures<LargeFigure> = {
    ...Object.fromEntries(groups),
    'memory.total': formatBytes(memory.totalBytes),
    'memory.peak': formatBytes(memory.peakBytes),
    'memory.largest': largest ? `${formatBytes(largest.bytes)} (${largest.label})` : UNKNOWN,
    'memory.limit': formatBytes(maxBufferBytes),
  };
  return { texts, bytes };
}
