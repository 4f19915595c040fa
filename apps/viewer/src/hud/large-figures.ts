import type { EngineMemory, FrameStatistics } from '@websplatter/core';
import { type Drawn, sideDrawn } from '../state/comparison.ts';
import type { ViewerState } from '../state/store.ts';
import type { TimeSummary } from '../state/time-summary.ts';
import { formatBytes, formatCount, formatMs, UNKNOWN } from '../ui/format.ts';
import type { Side } from './frame-recorder.ts';
import { type Figures, figuresOf } from './hud-figures.ts';
import { PASSES } from './pass-names.ts';

/** Figures of one side in the largest size. Those that are empty have no row. */
export function sideFigures(side: Side, state: ViewerState, summary: TimeSummary): Figures {
  const statistics = side === 'left' ? state.statistics : state.rightStatistics;
  const { sortKeyBits, resolutionScale } = drawnOf(side, state).accuracy;
  return figuresOf(side, {
    ...passFigures(statistics),
    candidates: formatCount(statistics?.candidateSplats ?? Number.NaN),
    pairs: statistics?.tilePairs == null ? '' : formatCount(statistics.tilePairs),
    sortKeys: `${sortKeyBits} bits`,
    scale: `${Math.round(100 * resolutionScale)} %`,
    median: formatMs(summary.median),
    p99: formatMs(summary.p99),
    peak: formatMs(summary.peak),
  });
}

function passFigures(statistics: FrameStatistics | null): Figures {
  const passMs = statistics?.timing.passMs ?? {};
  const textOf = (ms: number | undefined) => (ms === undefined ? '' : formatMs(ms));
  return Object.fromEntries(PASSES.map(([pass]) => [`pass.${pass}`, textOf(passMs[pass])]));
}

/** How one side of the image is drawn. */
export function drawnOf(side: Side, state: ViewerState): Drawn {
  const { comparison } = state;
  return comparison?.kind === 'split' ? sideDrawn(comparison[side], state) : state;
}

/** CPU time of a frame: calls to the engine, and the figures themselves. */
export function cpuFigures(render: TimeSummary, own: TimeSummary): Figures {
  return {
    renderMedian: formatMs(render.median),
    renderP99: formatMs(render.p99),
    ownMedian: formatMs(own.median),
    ownP99: formatMs(own.p99),
  };
}

/** Purposes of the GPU's memory. */
export const MEMORY_GROUPS = ['geometry', 'harmonics', 'bounds', 'frames', 'work'] as const;
export type MemoryGroup = (typeof MEMORY_GROUPS)[number];

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

/** GPU memory by group, and its known limit: WebGPU tells that of one buffer, not of all. */
export function memoryFigures(
  memory: EngineMemory | null,
  maxBufferBytes: number,
): { readonly texts: Figures; readonly bytes: Readonly<Record<MemoryGroup, number>> } {
  if (!memory) {
    return {
      texts: { 'memory.total': UNKNOWN },
      bytes: { geometry: 0, harmonics: 0, bounds: 0, frames: 0, work: 0 },
    };
  }
  const bytes = memoryByGroup(memory);
  const largest = memory.resources[0];
  const texts = figuresOf('memory', {
    ...Object.fromEntries(Object.entries(bytes).map(([group, held]) => [group, formatBytes(held)])),
    total: formatBytes(memory.totalBytes),
    peak: formatBytes(memory.peakBytes),
    largest: largest ? `${formatBytes(largest.bytes)} (${largest.label})` : UNKNOWN,
    limit: formatBytes(maxBufferBytes),
  });
  return { texts, bytes };
}
