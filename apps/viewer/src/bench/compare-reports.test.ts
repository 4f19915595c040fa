import { InvalidArgumentError } from '@websplatter/core';
import { describe, expect, it } from 'vitest';
import { benchReport } from './bench-report.fixture.ts';
import { benchJson } from './bench-report.ts';
import { comparedCell, comparedRows, differencesOf, readBenchReport } from './compare-reports.ts';

describe('reports of several devices', () => {
  it('are read as they were saved', () => {
    expect(readBenchReport(benchJson(benchReport()), 'a.json')).toEqual(benchReport());
  });

  it.each([
    ['text that is no JSON', 'hello'],
    ['null', 'null'],
    ['a report of something else', '{"measurement":{}}'],
  ])('refuses %s in words', (_, text) => {
    const read = () => readBenchReport(text, 'a.json');
    expect(read).toThrow(InvalidArgumentError);
    expect(read).toThrow('a.json is no report of this benchmark.');
  });

  it('name what they measured differently, and nothing that devices may differ in', () => {
    expect(differencesOf(benchReport(), benchReport({ adapter: 'vendor x2' }))).toEqual([]);
    expect(differencesOf(benchReport(), benchReport({ widthPx: 1, frames: 2 }))).toEqual(['Path']);
  });

  it('have their medians side by side, as multiples of the first', () => {
    const slower = benchReport({ gpuMs: null, stageMs: null, wallClockMs: benchReport().measurement.gpuMs! });
    const rows = comparedRows([benchReport(), slower]);
    expect(rows[0]).toEqual({ name: 'Pre-process', mediansMs: [1, null] });
    expect(rows.at(-1)).toEqual({ name: 'Whole frame, wall clock', mediansMs: [5, 4] });
    expect(comparedCell(4, 5)).toBe('4.000 (×\u00a00.80)');
    expect(comparedCell(5, 5)).toBe('5.000');
    expect(comparedCell(null, 5)).toBe('–');
    expect(comparedCell(4, null)).toBe('4.000');
    expect(comparedCell(4, 0)).toBe('4.000');
  });
});
