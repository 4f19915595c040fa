import { expect, test } from 'vitest';
import type { StreamRound, StreamRow, StreamsReport } from './report.ts';
import { reportText } from './table.ts';

function round(index: number, firstPictureMs: number, completeMs: number, turnMs: number): StreamRound {
  return {
    round: index,
    watched: { startedAtMs: 0, firstPictureMs, firstPsnrDb: 20 },
    streamed: { startedAtMs: 0, completeMs, longestTaskMs: 60, api: 'webgpu', note: 'by default' },
    state: { gpuBytes: 1e8, gpuPeakBytes: 2e8, adapter: 'test', figures: { splats: 1234 }, problems: [] },
    heap: { jsBytes: 5e6 },
    measured: { turnMs: [turnMs], orders: null, correctMs: [], gpuMs: [], byPass: null },
    bytes: { firstPicture: 1e6, complete: 2e7, rest: 2e7 + index, turn: 3e7 },
    requests: 9,
  };
}

function row(peer: string, fields: Partial<StreamRow>): StreamRow {
  return { peer, version: null, format: 'sog', rounds: [], pictures: [], failures: [], ...fields };
}

const REPORT: Omit<StreamsReport, 'rows'> = {
  date: '2026-01-01',
  ...{ command: 'bench', commit: null, machine: 'machine', browser: 'browser', adapter: null, wait: 'done' },
  size: { widthPx: 64, heightPx: 36 },
  pictureSize: { widthPx: 32, heightPx: 18 },
  ...{ frames: 3, maxSplats: 1e6, poolBytes: 2 ** 20, bitsPerSecond: 5e7, latencyMs: 40 },
};

test('ratios are beside the first peer, round by round, and missing figures are said', () => {
  const own = row('websplatter', { rounds: [round(0, 100, 400, 4), round(1, 200, 400, 4)] });
  const pictures = [{ camera: 'a', ownPsnrDb: 41, psnrDb: null, finestPsnrDb: null }];
  const other = row('other', { rounds: [round(0, 200, 800, 6)], pictures, failures: ['round 2: lost'] });
  const text = reportText({ ...REPORT, rows: [own, other, row('none', {})] });
  const cellsOf = (peer: string) =>
    text
      .split('\n')
      .find((line) => line.startsWith(`| ${peer} `))!
      .split('|')
      .map((cell) => cell.trim());
  expect(cellsOf('websplatter').slice(3, 5)).toEqual(['150', '1.00 (1.00–1.00)']);
  const expected = ['other', '–', '200', '2.00 (2.00–2.00)', '20', '1.0', '800', '2.00 (2.00–2.00)', '20.0'];
  expect(cellsOf('other').slice(1, 10)).toEqual(expected);
  expect(cellsOf('other').slice(-4, -1)).toEqual(['41.0 (41.0)', '–', '–']);
  expect(cellsOf('none').slice(3, 7)).toEqual(['–', '–', '–', '–']);
  expect(text).toContain('1,000,000 splats and 1 MiB, 50 Mbit/s, 40 ms to an answer');
  expect(text).toContain('- websplatter, round 2: 1 bytes came when it was complete');
  expect(text).not.toContain('round 1: 0 bytes');
  expect(text).toContain('- other FAILED: round 2: lost');
});
