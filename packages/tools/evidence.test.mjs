import { expect, test } from 'vitest';
import { parseEvidence } from '../../apps/docs/src/build/evidence.ts';
import { ratioTable, timeRatios } from './compare-results.mjs';
import { accuracyTables, benchTables, evidenceOf } from './evidence.mjs';

const spread = (median) => ({ median, p99: 2 * median });
const MEASUREMENT = {
  ...{ adapter: 'a GPU', loadedSplats: 9, widthPx: 30, heightPx: 20, frames: 5, notes: [] },
  ...{ stageMs: { sort: spread(1) }, gpuMs: spread(4), wallClockMs: spread(5) },
  passes: [{ part: 'sort', stage: 'sort-scatter', timeMs: spread(0.5) }],
};

/** The evidence as the site reads it from a file. */
const written = (evidence) => parseEvidence('a.json', JSON.stringify(evidence));

test('a bench becomes evidence that the site reads, with and without times of the GPU', () => {
  const run = { command: 'websplatter bench a.ply --size 30x20', commit: 'abc', adapter: 'a GPU' };
  const {
    title,
    run: conditions,
    tables,
    remarks,
  } = written(evidenceOf(run, benchTables({ scene: 'a.ply', measurement: MEASUREMENT }), ['slow', 'slow']));
  expect(title).toMatch(/^websplatter bench a\.ply, \d{4}-\d\d-\d\d$/);
  expect(conditions).toMatchObject(run);
  expect(tables.map(({ rows }) => rows)).toEqual([
    [
      ['sort', 1, 2],
      ['frame, GPU', 4, 8],
      ['frame, wall clock', 5, 10],
    ],
    [['sort', 'sort-scatter', 0.5, 1]],
  ]);
  expect(remarks).toEqual(['slow']);
  const untimed = { ...MEASUREMENT, stageMs: null, gpuMs: null, passes: null };
  const [only, ...others] = written(
    evidenceOf(
      { command: 'websplatter bench a', commit: null },
      benchTables({ scene: 'a', measurement: untimed }),
    ),
  ).tables;
  expect(only.rows).toEqual([['frame, wall clock', 5, 10]]);
  expect(others).toEqual([]);
});

test('settings compared become evidence; an image that equals the reference has no PSNR', () => {
  const point = (name, psnrDb) => ({
    ...{ name, splats: 9, bytes: 100 },
    ...{ error: { psnrDb, maxError: 0.1, ssim: 1 }, timeMs: { total: spread(3) } },
  });
  const report = { scenes: ['a', 'b'], distance: 2, widthPx: 30, heightPx: 20, frames: 5 };
  const tables = accuracyTables({ ...report, points: [point('fast', 40), point('reference', null)] });
  const [{ caption, rows }] = written(evidenceOf({ command: 'websplatter accuracy a b' }, tables)).tables;
  expect(caption).toBe('a, b from 2 times the distance, 30 × 20 px, 5 frames');
  expect(rows).toEqual([
    ['fast', 9, 40, 0.1, 1, 3, 6, 100],
    ['reference', 9, 'equal', 0.1, 1, 3, 6, 100],
  ]);
});

test('two checkouts compared become evidence', () => {
  const found = timeRatios([MEASUREMENT], [MEASUREMENT]);
  const evidence = written(
    evidenceOf({ command: 'compare-checkouts bench a' }, [ratioTable(found, 'a caption')]),
  );
  expect(evidence.tables[0].rows[0]).toEqual(['sort', 1, 1, 1, 1, 1, 2, 2, 1, 1, 1]);
});
