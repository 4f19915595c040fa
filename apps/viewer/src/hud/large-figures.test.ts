import { ACCURACY_PRESETS, type EngineMemory, type FrameStatistics } from '@websplatter/core';
import { describe, expect, it } from 'vitest';
import { createViewerStore, type ViewerState } from '../state/store.ts';
import { summarize } from '../state/time-summary.ts';
import { cpuFigures, drawnOf, memoryFigures, sideFigures } from './large-figures.ts';

const TIMES = summarize([1, 2, 30]);

const statistics = (tilePairs: number | null, passMs: object) =>
  ({
    candidateSplats: 1234,
    visibleSplats: 1000,
    tilePairs,
    timing: { preprocessMs: 1, sortMs: 2, rasterizeMs: 3.25, totalMs: 7, passMs },
  }) as FrameStatistics;

const stateWith = (changes: Partial<ViewerState>): ViewerState => ({
  ...createViewerStore().getState(),
  ...changes,
});

describe('the largest figures', () => {
  it('have the passes that a frame ran, and no row for others', () => {
    const state = stateWith({ statistics: statistics(5000, { 'tile-lists': 0.25, tiles: 3 }) });
    expect(sideFigures('left', state, TIMES)).toMatchObject({
      'left.pass.tile-lists': '0.25',
      'left.pass.tiles': '3.0',
      'left.pass.rasterize': '',
      'left.candidates': '1,234',
      'left.pairs': '5,000',
      'left.median': '2.0',
      'left.peak': '30.0',
    });
  });

  it('have no pairs where quads draw, and leave open what was not measured', () => {
    const byQuads = stateWith({ rightStatistics: statistics(null, {}) });
    expect(sideFigures('right', byQuads, TIMES)['right.pairs']).toBe('');
    expect(sideFigures('left', byQuads, summarize([]))).toMatchObject({
      'left.candidates': '–',
      'left.median': '–',
    });
  });

  it('have the bits of the sort keys of each side, and its resolution', () => {
    const { fast, reference } = ACCURACY_PRESETS;
    const state = stateWith({
      accuracy: reference,
      comparison: { kind: 'split', left: 'current', right: { ...fast, resolutionScale: 0.25 } },
    });
    expect(sideFigures('left', state, TIMES)['left.sortKeys']).toBe(`${reference.sortKeyBits} bits`);
    expect(sideFigures('right', state, TIMES)).toMatchObject({
      'right.sortKeys': `${fast.sortKeyBits} bits`,
      'right.scale': '25 %',
    });
  });

  it('know the detail of each side: the chosen one, and all splats for others', () => {
    const detail = { maxSplats: 1000 };
    const { fast } = ACCURACY_PRESETS;
    const state = stateWith({ detail, comparison: { kind: 'split', left: fast, right: 'current' } });
    expect(drawnOf('left', state)).toEqual({ accuracy: fast, detail: 'full' });
    expect(drawnOf('right', state).detail).toBe(detail);
    expect(drawnOf('left', { ...state, comparison: null }).detail).toBe(detail);
  });

  it('have the CPU time of calls and their own', () => {
    expect(cpuFigures(summarize([0.5]), summarize([0, 0.5]))).toEqual({
      renderMedian: '0.50',
      renderP99: '0.50',
      ownMedian: '0.25',
      ownP99: '0.50',
    });
  });

  it('have memory by group, its largest piece, and how large a buffer may be', () => {
    const memory: EngineMemory = {
      totalBytes: 9e6,
      peakBytes: 10e6,
      resources: [{ label: 'records', bytes: 2e6 }],
      scene: {
        totalBytes: 6e6,
        clouds: [
          {
            name: 'a',
            totalBytes: 4e6,
            geometryBytes: { f32: 1e6, packed: 5e5 },
            shBytes: { u8: 2.3e6 },
            chunksBytes: 2e5,
          },
          { name: 'b', totalBytes: 2e6, geometryBytes: { f32: 1.9e6 }, shBytes: {}, chunksBytes: 1e5 },
        ],
      },
      frames: { totalBytes: 2e6, views: [] },
    };
    const { texts, bytes } = memoryFigures(memory, 4_294_967_296);
    expect(texts).toMatchObject({
      'memory.total': '9.0 MB',
      'memory.frames': '2.0 MB',
      'memory.work': '1.0 MB',
      'memory.largest': '2.0 MB (records)',
      'memory.limit': '4.3 GB',
    });
    expect(bytes).toEqual({ geometry: 3.4e6, harmonics: 2.3e6, bounds: 3e5, frames: 2e6, work: 1e6 });
    expect(memoryFigures(null, Number.NaN).texts['memory.total']).toBe('–');
  });
});
