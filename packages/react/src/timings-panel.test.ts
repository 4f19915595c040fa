import { type FrameStatistics, type StageTimings, wallClockTimings } from '@websplatter/core';
import { expect, it } from 'vitest';
import { type EngineState, wordsFor } from './timings-panel.ts';

const gpuTiming: StageTimings = {
  source: 'gpu-timestamps',
  preprocessMs: 1.234,
  sortMs: 0.5,
  rasterizeMs: 12,
  totalMs: 13.734,
  wallClockMs: 15,
  passMs: {},
};
const statistics = (timing: StageTimings): FrameStatistics => ({
  frame: 1,
  loadedSplats: 5_834_784,
  candidateSplats: 2_000_000,
  visibleSplats: 1_234_567,
  cutErrorPx: null,
  rasterizer: 'quads',
  tilePairs: null,
  quadsSampleMs: null,
  timing,
});

const engine: EngineState = { framesDrawn: 130, memoryBytes: 512_345_678, nowMs: 1500 };
const before: EngineState = { ...engine, framesDrawn: 100, nowMs: 1250 };

it('shows stages, splats, frames, memory and the source of the times', () => {
  expect(wordsFor(statistics(gpuTiming), engine, before)).toEqual({
    values: {
      'Pre-process': '1.23 ms',
      Sort: '0.50 ms',
      Rasterise: '12.00 ms',
      Frame: '13.73 ms',
      'Wall clock': '15.00 ms',
      Rasteriser: 'quads',
      'Splats visible': '1,234,567',
      'Splats loaded': '5,834,784',
      'Frames per second': '120',
      'GPU memory': '512.3 MB',
    },
    note: 'GPU timestamps',
  });
});

it('labels wall-clock times', () => {
  const { values, note } = wordsFor(statistics(wallClockTimings(20)), engine, before);
  const unknown = { 'Pre-process': '–', Sort: '–', Rasterise: '–', Frame: '–' };
  expect(values).toMatchObject({ ...unknown, 'Wall clock': '20.00 ms' });
  expect(note).toBe('No GPU timestamps here');
});

it('labels timestamps that are far from the wall clock as doubtful', () => {
  const { values, note } = wordsFor(statistics({ ...gpuTiming, wallClockMs: 900 }), engine, before);
  expect(values).toMatchObject({ Frame: '13.73 ms', 'Wall clock': '900.00 ms' });
  expect(note).toBe('GPU timestamps, doubtful');
});

it('shows no rate where frames did not follow one another', () => {
  const rateSince = (state: EngineState | null) =>
    wordsFor(statistics(gpuTiming), engine, state).values['Frames per second'];
  expect(rateSince(null)).toBe('–');
  expect(rateSince(engine)).toBe('–');
  expect(rateSince({ ...before, nowMs: 100 })).toBe('–');
});
