import { ACCURACY_PRESETS, InvalidArgumentError } from '@websplatter/core';
import type { FrameMeasurement } from '@websplatter/core/measure';
import { describe, expect, it } from 'vitest';
import { fileNameOf } from '../page.tsx';
import {
  type BenchmarkReport,
  comparedRows,
  differencesOf,
  readReport,
  reportFacts,
  reportText,
} from './report.ts';

const spread = (median: number) => ({
  median,
  low: median,
  high: median,
  p99: 2 * median,
  standardDeviation: median / 10,
});
const count = { least: 1, median: 2, most: 3 };

/** A report like those of devices that have timestamps. */
function report(changes: Partial<FrameMeasurement> = {}): BenchmarkReport {
  return {
    version: '0.1.0',
    commit: 'abc',
    madeAt: '2026-01-02T03:04:05.678Z',
    machine: {
      browser: 'Browser/1',
      platform: 'Linux 6.1',
      architecture: null,
      model: null,
      threads: 8,
      memoryGiB: null,
    },
    scene: 'A scene/1',
    shDegree: 3,
    orbitDegrees: 15,
    accuracyLabel: 'fast,sortKeyBits:32',
    loadMs: 120.4,
    measurement: {
      adapter: 'vendor x1',
      settings: ACCURACY_PRESETS.balanced,
      rasterizer: { rasterizer: 'tiles', reason: 'a reason' },
      widthPx: 640,
      heightPx: 360,
      frames: 20,
      loadedSplats: 12_345,
      candidateSplats: count,
      visibleSplats: count,
      tilePairs: count,
      timing: 'gpu-timestamps',
      gpuMs: spread(4),
      wallClockMs: spread(5),
      stageMs: { preprocess: spread(1), sort: spread(0.5), rasterize: spread(2) },
      passes: null,
      copyBytesPerSecond: 4e11,
      memory: { totalBytes: 1e6, peakBytes: 2e6, resources: [] },
      notes: [],
      ...changes,
    },
  };
}

describe('a report of the benchmark', () => {
  it('names scene, path, settings, adapter, browser, machine and version', () => {
    const facts = new Map(reportFacts(report()));
    expect(facts.get('scene')).toBe('A scene/1, 12,345 splats, spherical harmonics of degree 3');
    expect(facts.get('image')).toBe(
      '640×360 px, fast,sortKeyBits:32, drawn by tiles (a reason); 20 frames over 15°',
    );
    expect(facts.get('adapter')).toBe('vendor x1');
    expect(facts.get('machine')).toBe('Linux 6.1, 8 threads');
    expect(facts.get('version')).toBe('0.1.0, commit abc');
  });

  it('is text with median, P99 and deviation, and has a file with a plain name', () => {
    const lines = reportText(report({ notes: ['A note.'] })).split('\n');
    expect(lines.find((line) => /^sort +0\.500 +1\.000$/.test(line))).toBeDefined();
    expect(lines.find((line) => /^whole, GPU +4\.000 +8\.000 +2\.00 +10\.0 %$/.test(line))).toBeDefined();
    expect(lines).toContain('note: A note.');
    expect(fileNameOf(['websplatter-bench', 'A scene/1', 'vendor x1'])).toBe(
      'websplatter-bench-A-scene-1-vendor-x1.json',
    );
  });
});

describe('reports of several devices', () => {
  it('are read as they were saved, by this page and by the command line', () => {
    expect(readReport(JSON.stringify(report()), 'a.json')).toEqual(report());
    const { machine: _, version: __, madeAt: ___, loadMs: ____, ...common } = report();
    expect(readReport(JSON.stringify(common), 'a.json')).toEqual(common);
  });

  /**
   * @fault Arguments: a file to compare with a benchmark is no report
   * @consequence the reason is shown, the report stays
   */
  it.each([
    ['text that is no JSON', 'hello'],
    ['null', 'null'],
    ['a report of something else', '{"measurement":{}}'],
    ['a report without a path', JSON.stringify({ ...report(), orbitDegrees: undefined })],
  ])('refuses %s in words', (_, text) => {
    const read = () => readReport(text, 'a.json');
    expect(read).toThrow(InvalidArgumentError);
    expect(read).toThrow('a.json is not a report of this benchmark.');
  });

  it('name what they measured differently, and nothing that devices may differ in', () => {
    expect(differencesOf(report(), report({ adapter: 'vendor x2' }))).toEqual([]);
    expect(differencesOf(report(), report({ widthPx: 1, frames: 2 }))).toEqual(['path']);
    expect(differencesOf(report(), report({ loadedSplats: 9 }))).toEqual(['scene']);
    expect(differencesOf(report(), report({ settings: ACCURACY_PRESETS.fast }))).toEqual(['accuracy']);
  });

  it('have their medians side by side, as multiples of the first', () => {
    const slower = report({ gpuMs: null, stageMs: null, wallClockMs: spread(4) });
    const rows = comparedRows([report(), slower]);
    expect(rows[0]).toEqual(['pre-process', '1.000', '–']);
    expect(rows.at(-1)).toEqual(['whole, wall clock', '5.000', '4.000 (×\u00a00.80)']);
    expect(comparedRows([report(), report()]).at(-1)).toEqual(['whole, wall clock', '5.000', '5.000']);
    const none = report({ wallClockMs: spread(0) });
    expect(comparedRows([none, report()]).at(-1)).toEqual(['whole, wall clock', '0.000', '5.000']);
  });
});
