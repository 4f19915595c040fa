import { expect, test } from 'vitest';
import { parseEvidence } from '../../../../docs/src/build/evidence.ts';
import { evidenceOf, filesOf } from './evidence.ts';
import type { ReportPart, RunReport } from './report.ts';

const RUN: RunReport = {
  date: '2026-01-02T03:04:05.000Z',
  command: 'npm run bench:peers -- --scenes a.ply',
  commit: 'abc',
  machine: 'a machine',
  browser: 'Chromium 1',
  adapter: null,
  wait: 'done',
  frames: 3,
};
const PARTS: ReportPart[] = [
  {
    heading: 'a: ply',
    rows: [
      ['peer', 'load', '×'],
      ['websplatter', '356', '1.00 (1.00–1.00)'],
      ['other', '1.50', '–'],
    ],
    notes: ['other complains'],
  },
];

test('a run becomes evidence that the site reads', () => {
  const evidence = evidenceOf(RUN, PARTS, ['load: ms']);
  expect(parseEvidence('a.json', JSON.stringify(evidence))).toEqual(evidence);
  expect(evidence.title).toBe('npm run bench:peers, 2026-01-02');
  expect(evidence.run).toEqual({
    commit: 'abc',
    date: '2026-01-02',
    machine: 'a machine',
    browser: 'Chromium 1',
    command: RUN.command,
  });
  expect(evidence.tables?.[0].rows).toEqual([
    ['websplatter', 356, '1.00 (1.00–1.00)'],
    ['other', '1.50', null],
  ]);
  expect(evidence.remarks).toEqual(['other complains', 'load: ms']);
});

test('files are those that are asked for', () => {
  const filesFor = (jsonFile: string | null, evidenceFile: string | null) => [
    ...filesOf({ jsonFile, evidenceFile }, RUN, PARTS, []).keys(),
  ];
  expect(filesFor(null, null)).toEqual([]);
  expect(filesFor('/r.json', '/e.json')).toEqual(['/r.json', '/e.json']);
});
