import type { HardCase, HardCaseReport, HardCaseResult } from '@websplatter/conformance';
import { describe, expect, it } from 'vitest';
import { fileNameOf } from '../page.tsx';
import { progressText, referenceDecibels, reportByCase } from './run-words.ts';

const CASES = ['one', 'two'].map(
  (name): HardCase => ({
    kind: 'arithmetic',
    name,
    group: 'counts',
    breaks: 'It breaks.',
    check: () => null,
  }),
);

function result(name: string, changes: Partial<HardCaseResult> = {}): HardCaseResult {
  return {
    name,
    group: 'counts',
    verdict: 'pass',
    failures: [],
    stages: {},
    worstStage: null,
    unsureSplats: 0,
    images: { quads: {}, tiles: {} },
    dropped: {},
    elapsedMs: 1,
    ...changes,
  };
}

describe('a run of the hard cases', () => {
  it('tells how far it is, what failed and what comes next', () => {
    expect(progressText([], CASES)).toBe('0 of 2 cases · now one');
    expect(progressText([result('one', { verdict: 'fail' })], CASES)).toBe(
      '1 of 2 cases · 1 failed · now two',
    );
    expect(
      progressText(
        CASES.map(({ name }) => result(name)),
        CASES,
      ),
    ).toBe('2 of 2 cases');
  });

  it('has a report with a line for each case below the worst figures', () => {
    const report: HardCaseReport = {
      program: 'Browser/1',
      version: '0.1.0',
      commit: null,
      adapter: 'vendor (x)',
      isSoftware: false,
      isTruncating: false,
      features: [],
      date: '2026-01-02',
      sizePx: 64,
      casesInAll: 2,
      casesChosen: 2,
      results: [result('one'), result('two', { verdict: 'fail', failures: ['two: it broke'] })],
    };
    const lines = reportByCase(report).split('\n');
    expect(lines[0]).toBe('WebSplatter: 1 of 2 hard cases pass');
    expect(lines.find((line) => line.startsWith('program'))).toContain('Browser/1');
    expect(lines.find((line) => /^one .*pass$/.test(line))).toBeDefined();
    expect(lines.find((line) => /^two .*fail$/.test(line))).toBeDefined();
    expect(fileNameOf(['websplatter-hard-cases', report.adapter, report.date])).toBe(
      'websplatter-hard-cases-vendor-x-2026-01-02.json',
    );
  });

  it('names what images reached, equal ones as exact', () => {
    const image = { camera: 'front', maxError: 0, minPsnrDb: 55 };
    const images = {
      quads: { reference: { ...image, psnrDb: 61.26 } },
      tiles: { reference: { ...image, psnrDb: Number.POSITIVE_INFINITY } },
    };
    expect(referenceDecibels({ images })).toEqual(['61.3', 'exact']);
    expect(referenceDecibels(result('one'))).toEqual(['–', '–']);
  });
});
