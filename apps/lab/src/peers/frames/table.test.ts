import { describe, expect, test } from 'vitest';
import type { Loaded, Measured } from '../page/protocol.ts';
import type { Report, Round, Row, SceneReport } from './report.ts';
import { reportText } from './table.ts';

const LOADED: Loaded = {
  loadMs: 1234.4,
  firstSplatsMs: 321,
  longestTaskMs: 60,
  api: 'webgpu',
  note: 'as it comes',
};

function round(fields: {
  correctMs: number[];
  index?: number;
  isLoads?: boolean;
  loaded?: Partial<Loaded>;
  orders?: number;
  byPass?: Measured['byPass'];
  problems?: string[];
}): Round {
  const {
    correctMs,
    index = 0,
    isLoads = false,
    loaded,
    orders = null,
    byPass = null,
    problems = [],
  } = fields;
  return {
    round: index,
    loaded: { ...LOADED, ...loaded },
    measured: isLoads ? null : { turnMs: [4, 5, 6], orders, correctMs, gpuMs: [2], byPass },
    state: {
      gpuBytes: 12e6,
      gpuPeakBytes: 3.2e8,
      adapter: 'test',
      figures: {},
      problems,
    },
    heap: { jsBytes: 4.56e6 },
  };
}

function row(peer: string, fields: Partial<Row>): Row {
  return {
    peer,
    isFloor: false,
    version: null,
    isReader: true,
    rounds: [],
    pictures: [],
    failures: [],
    ...fields,
  };
}

const SCENE: Omit<SceneReport, 'rows'> = {
  scene: 'a',
  format: { name: 'ply', variant: 'ascii' },
  fileBytes: 2e6,
  splats: 12_345,
  shDegree: 3,
};

function textOf(...rows: Row[]): string {
  return textOfScenes([{ ...SCENE, rows }]);
}

function textOfScenes(scenes: SceneReport[], isLoads = false): string {
  const report: Report = {
    date: '2026-01-01T00:00:00.000Z',
    command: 'npm run bench:peers -- --scenes a.ply',
    commit: 'abc',
    machine: 'a machine',
    browser: 'Chromium 1',
    adapter: 'an adapter',
    wait: 'done',
    isFromFile: false,
    isLoads,
    widthPx: 64,
    heightPx: 32,
    pictureWidthPx: 16,
    pictureHeightPx: 8,
    frames: 3,
    jumps: 2,
    scenes,
  };
  return reportText(report);
}

/** The cells of a peer's line. */
function cells(text: string, peer: string): string[] {
  const line = text.split('\n').find((each) => each.startsWith(`| ${peer} `))!;
  return line
    .split('|')
    .slice(1, -1)
    .map((cell) => cell.trim());
}

test('a line has medians and tails over all rounds, memory, and the least PSNR', () => {
  const pictures = [60, 40, 50].map((psnrDb, i) => ({ camera: `${i}`, psnrDb }));
  const rounds = [round({ correctMs: [1, 2, 3] }), round({ index: 1, correctMs: [4, 5, 60], orders: 7 })];
  expect(cells(textOf(row('websplatter', { version: '1.2.3', rounds, pictures })), 'websplatter')).toEqual([
    'websplatter',
    '1.2.3',
    '1234',
    '–',
    '321',
    '60',
    '3.50 / 60.00',
    '1.00 (1.00–1.00)',
    '5.00 / 6.00',
    '16',
    '2.00 / 2.00',
    '–',
    '7',
    '12 / 320',
    '4.6',
    '50.0 (40.0)',
  ]);
});

test('ratios are taken round by round', () => {
  const rounds = (...correctMs: number[]) => correctMs.map((ms, index) => round({ index, correctMs: [ms] }));
  const base = row('websplatter', { rounds: rounds(1, 10) });
  const other = row('other', { rounds: rounds(2, 40) });
  const once = row('once', { rounds: rounds(2, 40).slice(1) });
  const text = textOf(other, once, base);
  expect(cells(text, 'other')[7]).toBe('3.00 (2.00–4.00)');
  expect(cells(text, 'once')[7]).toBe('4.00 (4.00–4.00)');
});

test('loads are held against the floor of the same API, round by round', () => {
  const loads = (api: 'webgpu' | 'webgl2', ...loadMs: number[]) => ({
    rounds: loadMs.map((ms, index) => round({ index, correctMs: [1], loaded: { loadMs: ms, api } })),
  });
  const rows = [
    row('floor-webgl2', { isFloor: true, ...loads('webgl2', 1, 1) }),
    row('floor-webgpu', { isFloor: true, ...loads('webgpu', 100, 200) }),
    row('websplatter', loads('webgpu', 150, 250)),
    row('without-rounds', {}),
  ];
  const text = textOf(...rows);
  expect(cells(text, 'websplatter')[3]).toBe('1.38 (1.25–1.50)');
  for (const peer of ['floor-webgpu', 'without-rounds']) expect(cells(text, peer)[3]).toBe('–');
});

describe('loads alone', () => {
  const loads = (peer: string, ...loadMs: number[]) =>
    row(peer, {
      rounds: loadMs.map((ms, index) =>
        round({ index, correctMs: [], isLoads: true, loaded: { loadMs: ms } }),
      ),
    });
  const floor = { ...loads('floor-webgpu', 10, 10, 10), isFloor: true };

  test('have medians and tails, and ratios to the quickest other project', () => {
    const rows = [
      floor,
      loads('websplatter', 100, 90, 80),
      loads('slow', 300, 1, 300),
      loads('quick', 200, 180, 100),
    ];
    const text = textOfScenes([{ ...SCENE, rows }], true);
    expect(cells(text, 'websplatter')).toEqual([
      'websplatter',
      '–',
      '90 / 100',
      '9.00 (8.00–10.00)',
      '0.50 (0.50–0.80)',
      '321',
      '60',
      '12 / 320',
      '4.6',
      '–',
    ]);
    expect(cells(text, 'slow')[4]).toBe('1.50 (0.01–3.00)');
    expect(cells(text, 'quick')[4]).toBe('1.00 (1.00–1.00)');
    expect(cells(text, 'floor-webgpu')[4]).toBe('–');
    expect(text).not.toContain('correct frame:');
  });

  test('are compared with no other project where there is none', () => {
    const rows = [
      floor,
      loads('websplatter', 100),
      loads('websplatter?accuracy=fast', 50),
      loads('websplatter-three', 10),
    ];
    expect(cells(textOfScenes([{ ...SCENE, rows }], true), 'websplatter')[4]).toBe('–');
  });

  test('are summed up for all scenes; a peer that does not read a format is said not to', () => {
    const spz = { ...SCENE, scene: 'a.spz', format: { name: 'spz', variant: '4' }, fileBytes: 25e6 };
    const unread = row('old', { isReader: false });
    const text = textOfScenes(
      [
        { ...SCENE, rows: [loads('websplatter', 100, 90, 80), loads('old', 300)] },
        { ...spz, rows: [loads('websplatter', 50), unread] },
      ],
      true,
    );
    expect(cells(text, 'a')).toEqual(['a', 'ply ascii', '2.0', '90', '300']);
    expect(cells(text, 'a.spz')).toEqual(['a.spz', 'spz 4', '25', '50', '–']);
    expect(text).toContain('- old does not read spz 4');
    expect(text.match(/^\| old /gm)).toHaveLength(1);
  });
});

test('a failed peer has a reason instead of figures, and complaints are shown once', () => {
  const complaining = row('loud', {
    rounds: [1, 2].map(() => round({ correctMs: [1], problems: ['WebGPU: invalid'] })),
  });
  const text = textOf(complaining, row('broken', { failures: ['round 1: the page crashed'] }));
  expect(cells(text, 'broken').slice(1)).toEqual(Array(15).fill('–'));
  expect(text).toContain('- broken FAILED: round 1: the page crashed');
  expect(text.match(/loud complains: WebGPU: invalid/g)).toHaveLength(1);
});

test('the lines of a table are equally long', () => {
  const text = textOf(row('a', {}), row('a-longer-name', { rounds: [round({ correctMs: [1000] })] }));
  const lengths = text
    .split('\n')
    .filter((line) => line.startsWith('|'))
    .map((line) => line.length);
  expect(new Set(lengths).size).toBe(1);
  expect(text).toContain('### a: ply ascii, 2.0 MB, 12,345 splats, spherical harmonics of degree 3, 64×32');
});

describe('GPU time by pass', () => {
  const byFrames = (frameMs: number[], passMs: number) => {
    const passes = [
      [1, 2].map((part) => ({ name: 'draw', ms: part * passMs })),
      [{ name: 'draw', ms: passMs }],
    ];
    return row('', { rounds: [round({ correctMs: [1], byPass: { frameMs, passes } })] });
  };
  const three = (frameMs: number) =>
    textOf(
      { ...byFrames([1, 1, 2], 0.5), peer: 'floor-three?mesh' },
      { ...byFrames([2], 0.5), peer: 'websplatter' },
      { ...byFrames([frameMs], 0.5), peer: 'websplatter-three?mesh' },
    );

  test('is that of whole frames, and of passes of the same name together', () => {
    const text = three(3.25);
    expect(cells(text, 'websplatter')).toContain('2.00 / 2.00');
    expect(text).toMatch(/^\| floor-three\?mesh +\| draw +\| 1\.5 \| 1\.000 \/ 1\.500 \|$/m);
  });

  test('inside three.js is held against a canvas and three’s own frame with the same options', () => {
    expect(three(3.25)).toContain(
      '0.25 ms (0.25–0.25) above those of websplatter and floor-three?mesh together; within',
    );
    expect(three(3.5)).toContain(
      '0.50 ms (0.50–0.50) above those of websplatter and floor-three?mesh together; ABOVE',
    );
  });
});
