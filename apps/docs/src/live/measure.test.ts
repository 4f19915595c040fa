import { ACCURACY_PRESETS } from '@websplatter/core';
import type { AccuracyTable, FrameMeasurement } from '@websplatter/core/measure';
import { describe, expect, it } from 'vitest';
import { accuracyInWords, framesInWords } from './measure.ts';

const spread = { median: 1.5, p99: 2.25, standardDeviation: 0.125, low: 1, high: 2 };

const TABLE = {
  adapter: 'Some GPU',
  timing: 'gpu-timestamps',
  widthPx: 1280,
  heightPx: 720,
  splats: 150_000,
  frames: 15,
  notes: ['a note of the engine'],
  points: [
    {
      name: 'reference',
      settings: ACCURACY_PRESETS.reference,
      error: { psnrDb: Number.POSITIVE_INFINITY },
      timeMs: { total: spread },
      rasterizers: ['tiles'],
      bytes: 88_000_000,
    },
    {
      name: 'fast',
      settings: ACCURACY_PRESETS.fast,
      error: { psnrDb: 49.06 },
      timeMs: { total: spread },
      rasterizers: ['tiles', 'quads'],
      bytes: 36_000_000,
    },
  ],
} as unknown as AccuracyTable;

const FRAMES = {
  adapter: 'Some GPU',
  timing: 'wall-clock',
  widthPx: 256,
  heightPx: 144,
  loadedSplats: 5000,
  frames: 4,
  rasterizer: { rasterizer: 'quads', reason: 'it was faster' },
  stageMs: null,
  gpuMs: null,
  wallClockMs: spread,
  notes: [],
} as unknown as FrameMeasurement;

describe('measured accuracy', () => {
  it('is told in the viewer’s words: the adapter first, equal images as such', () => {
    const { facts, rows, notes } = accuracyInWords(TABLE, 'gpu');
    expect(facts.slice(0, 4)).toEqual(['Some GPU', 'GPU timestamps', '1280 × 720', '150,000 splats']);
    expect(rows).toEqual([
      ['reference', 'equal', '1.50', 'tiles', '88.0'],
      ['fast', '49.1', '1.50', 'tiles and quads', '36.0'],
    ]);
    expect(notes).toEqual(['a note of the engine']);
  });
});

describe('measured frames', () => {
  it('have whole frames by the wall clock alone where the GPU tells no times, which is said', () => {
    const { rows, notes, facts } = framesInWords(FRAMES, 'software');
    expect(rows).toEqual([['Whole frame, wall clock', '1.500', '2.250', '0.125']]);
    expect(facts).toContain('drawn by quads (it was faster)');
    expect(notes[0]).toMatch(/^Measured on a software adapter/);
    expect(notes[1]).toMatch(/wall clock/);
  });

  it('have a row for each stage where it does', () => {
    const stageMs = { preprocess: spread, sort: spread, rasterize: spread };
    const measured = { ...FRAMES, timing: 'gpu-timestamps', stageMs, gpuMs: spread } as FrameMeasurement;
    expect(framesInWords(measured, 'gpu').rows.map(([name]) => name)).toEqual([
      'Pre-process',
      'Sort',
      'Rasterise',
      'Whole frame, GPU',
      'Whole frame, wall clock',
    ]);
  });
});
