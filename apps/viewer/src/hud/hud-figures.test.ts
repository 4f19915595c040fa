import {
  ACCURACY_PRESETS,
  type EngineMemory,
  type FrameStatistics,
  type RasterizerReport,
  wallClockTimings,
} from '@websplatter/core';
import { describe, expect, it } from 'vitest';
import { createViewerStore, type ViewerState } from '../state/store.ts';
import {
  cpuFigures,
  drawnOf,
  frameFigures,
  headline,
  memoryByGroup,
  memoryFigures,
  PASSES,
  sideFigures,
  stageFigures,
  stageShares,
} from './hud-figures.ts';

const hudText = (state: ViewerState) => ({ ...frameFigures(state), ...stageFigures('left', state) });

/** A scene of 31,000 splats, 2,000 of them in a file that may be hidden. */
const sceneOf = (isOtherHidden = false) => {
  const parts = [
    { splats: 29_000, cloudKeys: ['1/0'], look: { isHidden: false } },
    { splats: 2000, cloudKeys: ['2/0'], look: { isHidden: isOtherHidden } },
  ];
  return { splats: 31_000, parts } as unknown as ViewerState['scene'];
};

function stateWith(timing: object, changes: Partial<ViewerState> = {}): ViewerState {
  const statistics = {
    frame: 1,
    visibleSplats: 1200,
    candidateSplats: 2000,
    loadedSplats: 5000,
    rasterizer: 'tiles',
    tilePairs: 3000,
    quadsSampleMs: null,
    timing,
  };
  return {
    ...createViewerStore().getState(),
    statistics: statistics as ViewerState['statistics'],
    ...changes,
  };
}

const MEASURED = {
  source: 'gpu-timestamps',
  preprocessMs: 1,
  sortMs: 2,
  rasterizeMs: 5,
  totalMs: 8,
  wallClockMs: 9,
};
const WALL_CLOCK = {
  source: 'wall-clock',
  preprocessMs: Number.NaN,
  sortMs: Number.NaN,
  rasterizeMs: Number.NaN,
  totalMs: 8,
};

describe('HUD', () => {
  it('writes each stage and where the times come from', () => {
    const text = hudText(stateWith(MEASURED));
    expect(text).toMatchObject({
      preprocess: '1.0',
      sort: '2.0',
      rasterize: '5.0',
      total: '8.0',
      visible: '1,200',
    });
    expect(text.source).toBe('GPU timestamps');
  });

  it('says what is there of scenes that stream, and nothing of others', () => {
    expect(hudText(stateWith(MEASURED))).toMatchObject({ bricks: '', fetched: '' });
    const streaming = {
      bricks: 1640,
      residentBricks: 412,
      missingBricks: 38,
      fetchedBytes: 12_400_000,
      bytesPerSecond: 3_140_000,
      error: null,
    };
    expect(hudText(stateWith(MEASURED, { streaming }))).toMatchObject({
      bricks: '412 of 1,640, 38 on the way',
      // What is on the GPU, not what the file holds.
      loaded: '5,000',
      fetched: '12 MB, 3.1 MB/s',
    });
    const failed = { ...streaming, error: new Error('gone') };
    expect(hudText(stateWith(MEASURED, { streaming: failed })).bricks).toBe('412 of 1,640, 38 not fetched');
    const atRest = { ...streaming, missingBricks: 0, bytesPerSecond: 0 };
    expect(hudText(stateWith(MEASURED, { streaming: atRest }))).toMatchObject({
      bricks: '412 of 1,640',
      fetched: '12 MB',
    });
  });

  it('says how many splats are left once some are not', () => {
    const whole = { scene: sceneOf() };
    expect(hudText(stateWith(MEASURED, whole))).toMatchObject({ left: '', loaded: '31,000' });
    const hidden = { scene: sceneOf(true) };
    expect(hudText(stateWith(MEASURED, hidden))).toMatchObject({ left: '29,000', loaded: '31,000' });
  });

  it('names the detail that was drawn, where the labels of a split image do not', () => {
    const scene = sceneOf();
    const changes = { drawnDetail: { maxSplats: 3100 }, scene };
    const state = stateWith(MEASURED, changes);
    expect(hudText(state).detail).toBe('3,100 of 31,000 splats');
    const statistics = { ...state.statistics!, cutErrorPx: 8.4134 };
    expect(hudText({ ...state, statistics }).detail).toBe('3,100 of 31,000 splats, up to 8.4 px off');
    const far = { ...state.statistics!, cutErrorPx: 1274.6 };
    expect(hudText({ ...state, statistics: far }).detail).toBe('3,100 of 31,000 splats, up to 1,300 px off');
    expect(hudText({ ...state, statistics, drawnDetail: { maxErrorPx: 1 } }).detail).toBe(
      'errors up to 1 px',
    );
    const inMotion = { ...state, movingScale: 0.5 };
    expect(hudText(inMotion).detail).toBe('3,100 of 31,000 splats, half the resolution');
    expect(hudText({ ...inMotion, drawnDetail: 'full' }).detail).toBe('half the resolution');
    const comparison = { kind: 'split', left: 'current', right: 'current' } as const;
    expect(hudText(stateWith(MEASURED, { comparison, ...changes })).detail).toBe('');
    expect(hudText(stateWith(MEASURED, { detail: 'auto' })).detail).toBe('');
  });

  it('says so where timestamps cannot be true', () => {
    const { source } = hudText(stateWith({ ...MEASURED, wallClockMs: 250 }));
    expect(source).toBe('GPU timestamps; the clock says 250 ms');
  });

  it('leaves open what the wall clock cannot tell', () => {
    expect(hudText(stateWith(WALL_CLOCK))).toMatchObject({
      preprocess: '–',
      total: '8.0',
      source: 'wall clock',
    });
    expect(stageShares(stateWith(WALL_CLOCK).statistics)).toEqual({
      preprocess: 0,
      sort: 0,
      rasterize: 0,
      rest: 0,
    });
  });

  it('says in one line what moves at which rate, and what a picture at rest has cost', () => {
    const frameRate = { frameMs: 20, framesPerSecond: 50 };
    expect(headline(stateWith(MEASURED, { frameRate, isIdle: false }))).toEqual({
      figure: '50',
      unit: 'fps',
      about: '20.0 ms from frame to frame',
    });
    // The same figure as the sum of the stages, not the last pace.
    const atRest = stateWith(MEASURED, { frameRate, isIdle: true });
    expect(headline(atRest)).toEqual({ figure: '8.0', unit: 'ms', about: 'to draw, at rest' });
    expect(headline(atRest).figure).toBe(hudText(atRest).total);
    // Both sides of a split image are drawn.
    expect(headline({ ...atRest, rightStatistics: atRest.statistics }).figure).toBe('16.0');
    // A frame alone, as in a slow drag, has no rate.
    expect(headline(stateWith(MEASURED, { isIdle: false }))).toMatchObject({
      figure: '8.0',
      about: 'to draw',
    });
  });

  it('says that a scene is loading, at the first start and beside the scene before it', () => {
    const loading = { figure: 'Loading', unit: '', about: '' };
    expect(headline(createViewerStore().getState())).toEqual(loading);
    const load = { title: 'a.ply' } as ViewerState['load'];
    expect(headline(stateWith(MEASURED, { load, isIdle: true }))).toEqual(loading);
    // Parts of a scene that streams, none of which is on the screen.
    const streaming = { missingBricks: 2, error: null } as ViewerState['streaming'];
    const first = stateWith(MEASURED, { streaming, isIdle: true });
    const black = { ...first, statistics: { ...first.statistics!, visibleSplats: 0 } };
    expect(headline(black)).toEqual(loading);
    expect(headline(first).about).toBe('to draw, at rest');
    const empty = { ...createViewerStore().getState(), status: 'running' } as const;
    expect(headline(empty)).toMatchObject({ figure: '–', about: 'nothing drawn yet' });
  });

  describe('says which rasteriser drew', () => {
    const report = {
      rasterizer: 'tiles',
      reason: 'they have not been compared yet',
      tilesMs: null,
      quadsMs: null,
    } as const;
    const textWith = (statistics: Partial<FrameStatistics>, rasterizer: RasterizerReport = report) => {
      const state = stateWith(MEASURED, { rasterizer });
      return hudText({ ...state, statistics: { ...state.statistics!, ...statistics } });
    };

    it('why, and how long the other takes once that is known', () => {
      expect(textWith({})).toMatchObject({
        rasterizer: 'tiles',
        otherRasterizer: '',
        rasterizerReason: 'They have not been compared yet',
      });
      const compared = { ...report, reason: 'tiles take 1.2 ms', tilesMs: 1.2, quadsMs: 22 };
      expect(textWith({}, compared)).toMatchObject({
        otherRasterizer: '(quads 22.0 ms)',
        rasterizerReason: 'Tiles take 1.2 ms',
      });
      expect(textWith({ rasterizer: 'quads' }, { ...compared, rasterizer: 'quads' })).toMatchObject({
        rasterizer: 'quads',
        otherRasterizer: '(tiles 1.2 ms)',
      });
    });

    it('where the tiles had no room, or the other one is next', () => {
      expect(textWith({ rasterizer: 'quads' })).toMatchObject({
        rasterizer: 'quads',
        rasterizerReason: 'This frame had no room for the lists of its tiles',
      });
      expect(textWith({ rasterizer: 'quads', tilePairs: null }).rasterizerReason).toBe(
        'Tiles are next: they have not been compared yet',
      );
    });

    it('and nothing before the first measurement', () => {
      expect(hudText(createViewerStore().getState())).toMatchObject({
        rasterizer: '–',
        otherRasterizer: '',
        rasterizerReason: '',
      });
    });
  });

  it('adds up: what no stage takes is the rest, in figures and in the bar', () => {
    const state = stateWith({ ...MEASURED, totalMs: 16 });
    expect(hudText(state)).toMatchObject({ rest: '8.0', total: '16.0' });
    expect(stageShares(state.statistics)).toEqual({
      preprocess: 1 / 16,
      sort: 1 / 8,
      rasterize: 5 / 16,
      rest: 1 / 2,
    });
  });
});

const TIMES = [1, 2, 30].map((ms) => ({ timing: wallClockTimings(ms) }) as FrameStatistics);

const statisticsOf = (tilePairs: number | null, passMs: object) =>
  ({
    candidateSplats: 1234,
    visibleSplats: 1000,
    tilePairs,
    timing: { preprocessMs: 1, sortMs: 2, rasterizeMs: 3.25, totalMs: 7, wallClockMs: 8, passMs },
  }) as FrameStatistics;

const viewerState = (changes: Partial<ViewerState>): ViewerState => ({
  ...createViewerStore().getState(),
  ...changes,
});

describe('the largest figures', () => {
  it('have the passes that a frame ran, and no row for others', () => {
    const state = viewerState({ statistics: statisticsOf(5000, { 'tile-lists': 0.25, tiles: 3 }) });
    const { passes, ...figures } = sideFigures('left', state, TIMES);
    expect(figures).toMatchObject({ pairs: '5,000', median: '2.0', peak: '30.0' });
    const textOf = (name: string) => passes[PASSES.findIndex(([pass]) => pass === name)];
    expect(['tile-lists', 'tiles', 'rasterize'].map(textOf)).toEqual(['0.25', '3.0', '']);
    expect(stageFigures('left', state).candidates).toBe('1,234');
  });

  it('have no pairs where quads draw, and leave open what was not measured', () => {
    const byQuads = viewerState({ rightStatistics: statisticsOf(null, {}) });
    expect(sideFigures('right', byQuads, TIMES).pairs).toBe('');
    expect(sideFigures('left', byQuads, []).median).toBe('–');
    expect(stageFigures('left', byQuads).candidates).toBe('–');
  });

  it('have the bits of the sort keys of each side, and its resolution', () => {
    const { fast, reference } = ACCURACY_PRESETS;
    const state = viewerState({
      accuracy: reference,
      comparison: { kind: 'split', left: 'current', right: { ...fast, resolutionScale: 0.25 } },
    });
    expect(sideFigures('left', state, TIMES).sortKeys).toBe(`${reference.sortKeyBits} bits`);
    expect(sideFigures('right', state, TIMES)).toMatchObject({
      sortKeys: `${fast.sortKeyBits} bits`,
      scale: '25 %',
    });
    expect(sideFigures('left', { ...state, movingScale: 0.5 }, TIMES).scale).toBe('50 %');
  });

  it('know the detail of each side: the chosen one, and all splats for others', () => {
    const detail = { maxSplats: 1000 };
    const { fast } = ACCURACY_PRESETS;
    const state = viewerState({ detail, comparison: { kind: 'split', left: fast, right: 'current' } });
    expect(drawnOf('left', state)).toEqual({ accuracy: fast, detail: 'full' });
    expect(drawnOf('right', state).detail).toBe(detail);
    expect(drawnOf('left', { ...state, comparison: null }).detail).toBe(detail);
  });

  it('have the median and the tail of CPU times', () => {
    expect(cpuFigures([0, 0.5])).toEqual({ median: '0.25', p99: '0.50' });
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
    expect(memoryFigures(memory, 4_294_967_296)).toEqual({
      total: '9.0 MB',
      peak: '10 MB',
      largest: '2.0 MB (records)',
      limit: '4.3 GB',
    });
    expect(memoryByGroup(memory)).toEqual({
      geometry: 3.4e6,
      harmonics: 2.3e6,
      bounds: 3e5,
      frames: 2e6,
      work: 1e6,
    });
    expect(memoryFigures(null, Number.NaN).total).toBe('–');
  });
});
