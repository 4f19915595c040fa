import { expect, test } from 'vitest';
import {
  failureLines,
  type HardCaseReport,
  jsonReport,
  markdownReport,
  resultHeading,
  resultLine,
  summaryLine,
  textReport,
} from './report.ts';
import type { HardCaseResult } from './run-result.ts';

const stage = {
  field: 'minorLengthPx',
  cloudIndex: 0,
  splatIndex: 3,
  got: 0.77459,
  expected: 0.7745966,
  error: 6.6e-6,
  bound: 1.1e-5,
  ratio: 0.6,
  camera: 'front',
  preset: 'reference',
} as const;

const PASSED: HardCaseResult = {
  name: 'needle',
  group: 'scale',
  verdict: 'pass',
  failures: [],
  stages: { reference: { minorLengthPx: stage } },
  worstStage: stage,
  unsureSplats: 0,
  images: {
    quads: {
      reference: { camera: 'front', psnrDb: 137.25, maxError: 1e-6, minPsnrDb: 55 },
      high: { camera: 'front', psnrDb: Number.POSITIVE_INFINITY, maxError: 0, minPsnrDb: null },
    },
    tiles: { reference: { camera: 'front', psnrDb: 131.5, maxError: 1.25e-6, minPsnrDb: 55 } },
  },
  dropped: {},
  elapsedMs: 1500,
};

const FAILED: HardCaseResult = {
  ...PASSED,
  name: 'sort-all-equal',
  group: 'sort',
  verdict: 'fail',
  failures: ['sort-all-equal, 9 keys of 16 bits: place 1 | 2'],
  stages: {},
  worstStage: null,
  images: { quads: {}, tiles: {} },
};

const REPORT: HardCaseReport = {
  adapter: 'acme gpu',
  isSoftware: false,
  isTruncating: true,
  features: ['float32-blendable', 'timestamp-query'],
  program: 'Acme Browser 1',
  version: '0.1.0',
  date: '2026-01-02',
  commit: 'abc',
  sizePx: 64,
  casesInAll: 2,
  casesChosen: 2,
  results: [PASSED, FAILED],
};

test('a line lists stage, decibels per rasteriser and preset, error and verdict under its heading', () => {
  const [heading, line, failed] = [resultHeading(16), resultLine(PASSED, 16), resultLine(FAILED, 16)];
  expect(line.split(/ {2,}/)).toEqual([
    'needle',
    'minorLengthPx 6.6e-6 (0.60)',
    '137.3',
    'exact',
    '–',
    '131.5',
    '1.3e-6',
    'pass',
  ]);
  expect(failed.split(/ {2,}/)).toEqual(['sort-all-equal', ...Array(6).fill('–'), 'fail']);
  expect(line.indexOf('pass')).toBe(heading.indexOf('verdict'));
  expect(failed.indexOf('fail')).toBe(heading.indexOf('verdict'));
});

test('the summary states how many cases passed, where, when and in what time', () => {
  expect(summaryLine(REPORT)).toBe(
    '1 of 2 hard cases pass in 3.0 s (acme gpu, 64×64, 2026-01-02, commit abc)',
  );
  expect(summaryLine({ ...REPORT, commit: null })).toMatch(/2026-01-02\)$/);
});

test('a report of a part says so', () => {
  const part = { ...REPORT, casesInAll: 9 };
  expect(summaryLine(part)).toMatch(/^1 of 2 chosen hard cases \(9 in all\) pass in 3\.0 s /);
  expect(textReport(part)).toMatch(/^WebSplatter: 1 of 2 chosen hard cases \(9 in all\) pass\n/);
  const stopped = { ...REPORT, casesInAll: 9, casesChosen: 9 };
  expect(textReport(stopped)).toMatch(/^WebSplatter: 1 of 2 hard cases \(stopped before 7 more\) pass\n/);
  expect(textReport({ ...part, casesChosen: 4 })).toContain('(9 in all, stopped before 2 more)');
});

test('markdown has a row per case and lists failures', () => {
  const lines = markdownReport(REPORT).split('\n');
  expect(lines.filter((line) => line.startsWith('| '))).toHaveLength(4);
  expect(lines).toContain(
    '| scale | needle | minorLengthPx 6.6e-6 (0.60) | 137.3 | exact | – | 131.5 | 1.3e-6 | pass |',
  );
  expect(lines).toContain(`- ${FAILED.failures[0]}`);
  expect(markdownReport({ ...REPORT, results: [PASSED] })).not.toContain('Failures');
});

test('JSON keeps infinities as text', () => {
  const read = JSON.parse(jsonReport(REPORT));
  expect(read.results[0].images.quads.high.psnrDb).toBe('Infinity');
  expect(read.results[0].images.quads.reference.psnrDb).toBe(137.25);
});

test('failures are listed as they are', () => {
  expect(failureLines(REPORT.results)).toEqual(FAILED.failures);
});

test('the text to paste has adapter, program, version, worst figures and failures', () => {
  expect(textReport(REPORT).split('\n')).toEqual([
    'WebSplatter: 1 of 2 hard cases pass',
    'adapter              acme gpu',
    'program              Acme Browser 1',
    'version              0.1.0, commit abc',
    'date                 2026-01-02',
    'images               64×64',
    'features             float32-blendable timestamp-query',
    'halves               blended by truncation',
    'quads, reference dB  137.3 at worst (needle)',
    'quads, high dB       exact at worst (needle)',
    'quads, balanced dB   –',
    'tiles, reference dB  131.5 at worst (needle)',
    'stages               minorLengthPx 0.60 of its bound at worst (needle)',
    'time                 3.0 s',
    '',
    FAILED.failures[0],
    '',
  ]);
  const sound = { ...REPORT, isSoftware: true, isTruncating: false, commit: null, results: [PASSED] };
  const lines = textReport(sound).split('\n');
  expect(lines).toContain('adapter              acme gpu, software');
  expect(lines).toContain('version              0.1.0');
  expect(lines).toContain('halves               blended to the nearest');
  expect(lines.slice(-2)).toEqual(['time                 1.5 s', '']);
});
