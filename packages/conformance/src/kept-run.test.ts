import { expect, test } from 'vitest';
import { keepRun, keptRun, keptVerdict, unrunFirst, verdictOn } from './kept-run.ts';
import type { HardCaseReport } from './report.ts';

const NAMES = ['a', 'b', 'c', 'd'];

function storage() {
  const items = new Map<string, string>();
  return {
    getItem: (key: string) => items.get(key) ?? null,
    setItem: (key: string, value: string) => void items.set(key, value),
  };
}

function report(verdicts: Record<string, 'pass' | 'fail'>, others: object = {}): HardCaseReport {
  const results = Object.entries(verdicts).map(([name, verdict]) => ({ name, verdict }));
  return { version: '1', commit: null, adapter: 'x', date: '2026-11-25', ...others, results } as never;
}

test('a run is kept beside those before it, and tells what passes, fails and has not run', () => {
  const kept = storage();
  expect(keptRun(kept)).toBeNull();
  keepRun(report({ a: 'pass', b: 'fail' }), kept);
  expect(keptVerdict(keptRun(kept)!, NAMES)).toBe(
    '1 of 4 cases pass on this device: 1 fails, 2 have not run',
  );
  expect(
    unrunFirst(
      NAMES.map((name) => ({ name })),
      keptRun(kept),
    ).map(({ name }) => name),
  ).toEqual(['c', 'd', 'a', 'b']);
  expect(['a', 'b', 'c'].map((name) => verdictOn(name, keptRun(kept)))).toEqual(['pass', 'fail', null]);
  keepRun(report({ b: 'pass', c: 'pass', d: 'pass' }, { date: '2026-11-26' }), kept);
  expect(keptRun(kept)).toMatchObject({ date: '2026-11-26', failed: [] });
  expect(keptVerdict(keptRun(kept)!, NAMES)).toBe('4 of 4 cases pass on this device');
});

test.each([{ version: '2' }, { commit: 'abc' }, { adapter: 'y' }])('a run with %o begins anew', (other) => {
  const kept = storage();
  keepRun(report({ a: 'pass' }), kept);
  keepRun(report({ b: 'fail' }, other), kept);
  expect(keptRun(kept)).toMatchObject({ passed: [], failed: ['b'], ...other });
});

test('browsers that keep nothing, or something else, have none', () => {
  const closed = {
    getItem: () => {
      throw new DOMException('closed', 'SecurityError');
    },
    setItem: () => {
      throw new DOMException('full', 'QuotaExceededError');
    },
  };
  keepRun(report({ a: 'pass' }), closed);
  expect(keptRun(closed)).toBeNull();
  for (const text of ['{', '3', '{"passed":1}']) {
    expect(keptRun({ getItem: () => text, setItem: () => {} })).toBeNull();
  }
  expect(keptRun(undefined)).toBeNull();
  expect(verdictOn('a', null)).toBeNull();
});
