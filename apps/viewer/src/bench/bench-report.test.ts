import { describe, expect, it } from 'vitest';
import { benchReport } from './bench-report.fixture.ts';
import { benchFacts, benchFileName, benchJson, benchText, timeRows } from './bench-report.ts';

describe('a report of the benchmark', () => {
  it('has a row for each stage and for whole frames, and only the wall clock’s without timestamps', () => {
    expect(timeRows(benchReport().measurement).map(({ name }) => name)).toEqual([
      'Pre-process',
      'Sort',
      'Rasterize',
      'Whole frame, GPU',
      'Whole frame, wall clock',
    ]);
    const untimed = benchReport({ gpuMs: null, stageMs: null }).measurement;
    expect(timeRows(untimed).map(({ name }) => name)).toEqual(['Whole frame, wall clock']);
  });

  it('names scene, path, settings, adapter, browser, machine and version', () => {
    const facts = new Map(benchFacts(benchReport()));
    expect(facts.get('Scene')).toBe('A scene/1, 12,345 splats, harmonics of degree 3');
    expect(facts.get('Path')).toBe('20 frames over 15°, 640×360 px');
    expect(facts.get('Accuracy')).toContain('sortKeyBits ');
    expect(facts.get('Adapter')).toBe('vendor x1');
    expect(facts.get('Machine')).toBe('Linux 6.1, 8 threads');
    expect(facts.get('Version')).toBe('0.1.0, commit abc');
  });

  it('is text with median, P99 and deviation, JSON that can be read again, and a file with a plain name', () => {
    const report = { ...benchReport(), notes: ['A note.'] };
    const lines = benchText(report).split('\n');
    expect(lines).toContain('| Sort | 0.500 | 1.000 | 0.050 |');
    expect(lines).toContain('Note: A note.');
    expect(JSON.parse(benchJson(report))).toEqual(report);
    expect(benchFileName(report)).toBe('websplatter-bench-A-scene-1-vendor-x1-2026-01-02.json');
  });
});
