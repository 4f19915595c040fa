import {
  ACCURACY_PRESETS,
  type FrameStatistics,
  type StageTimings,
  wallClockTimings,
} from '@websplatter/core';
import { describe, expect, it } from 'vitest';
import { createViewerStore } from '../state/store.ts';
import { csvReport, jsonReport, type Recorded } from './hud-report.ts';

const GPU: StageTimings = {
  source: 'gpu-timestamps',
  preprocessMs: 1,
  sortMs: 2,
  rasterizeMs: 5,
  totalMs: 8.5,
  wallClockMs: 9,
  passMs: { preprocess: 1, sort: 2, 'tile-lists': 1.5, tiles: 3.5 },
};

const frame = (timing: StageTimings, tilePairs: number | null): FrameStatistics => ({
  frame: 7,
  loadedSplats: 100,
  candidateSplats: 60,
  visibleSplats: 50,
  cutErrorPx: null,
  rasterizer: tilePairs === null ? 'quads' : 'tiles',
  tilePairs,
  quadsSampleMs: null,
  timing,
});

function recorded(changes: Partial<Recorded> = {}): Recorded {
  return {
    state: { ...createViewerStore().getState(), adapterLabel: 'a GPU', widthPx: 30, heightPx: 20 },
    frames: { left: [frame(GPU, 300)], right: [frame(wallClockTimings(4), null)] },
    renderMs: [0.5],
    ownMs: [0.125],
    memory: null,
    maxBufferBytes: 4_294_967_296,
    maxBindingBytes: null,
    program: 'a browser',
    madeAt: new Date(Date.UTC(2026, 0, 2)),
    ...changes,
  };
}

const split = (): Recorded['state'] => ({
  ...recorded().state,
  comparison: { kind: 'split', left: 'current', right: ACCURACY_PRESETS.fast },
});

describe('a report of frames', () => {
  it('says as JSON what was drawn, on what, and how long each stage took', () => {
    const report = JSON.parse(jsonReport(recorded()));
    expect(report).toMatchObject({
      madeAt: '2026-01-02T00:00:00.000Z',
      program: 'a browser',
      adapter: 'a GPU',
      image: { widthPx: 30, heightPx: 20 },
      cpu: { renderCallsMs: { median: 0.5 }, figuresMs: { mean: 0.125 } },
      memory: null,
    });
    expect(report.sides.left.stagesMs.total).toEqual({ median: 8.5, p99: 8.5, peak: 8.5, mean: 8.5 });
    expect(report.sides.left.frames[0].timing.passMs.tiles).toBe(3.5);
    expect(Object.keys(report.sides)).toEqual(['left']);
  });

  it('has both sides of a split image, each with its settings, and null for unknown values', () => {
    const { sides } = JSON.parse(jsonReport(recorded({ state: split() })));
    expect(sides.right.accuracy).toEqual({ ...ACCURACY_PRESETS.fast });
    expect(sides.right.stagesMs.sort.median).toBeNull();
    expect(sides.right.stagesMs.total.median).toBe(4);
  });

  it('has memory by group and its limits', () => {
    const memory: Recorded['memory'] = {
      totalBytes: 10,
      peakBytes: 12,
      resources: [],
      scene: { totalBytes: 0, clouds: [] },
      frames: { totalBytes: 4, views: [] },
    };
    expect(JSON.parse(jsonReport(recorded({ memory }))).memory).toEqual({
      totalBytes: 10,
      peakBytes: 12,
      groupBytes: { geometry: 0, harmonics: 0, bounds: 0, frames: 4, work: 6 },
      maxBufferBytes: 4_294_967_296,
      maxBindingBytes: null,
    });
  });

  it('has a row per frame as CSV, with empty cells for what is unknown', () => {
    const [header, left, right, end] = csvReport(recorded({ state: split() })).split('\n');
    const columns = header.split(',');
    const cells = (row: string) => Object.fromEntries(row.split(',').map((text, i) => [columns[i], text]));
    expect(left.split(',')).toHaveLength(columns.length);
    expect(cells(left)).toMatchObject({
      side: 'left',
      frame: '7',
      source: 'gpu-timestamps',
      sort_ms: '2',
      rasterizer: 'tiles',
      tile_pairs: '300',
      pass_tile_lists_ms: '1.5',
      pass_rasterize_ms: '',
    });
    expect(cells(right)).toMatchObject({
      side: 'right',
      source: 'wall-clock',
      sort_ms: '',
      total_ms: '4',
      tile_pairs: '',
    });
    expect(end).toBe('');
  });
});
