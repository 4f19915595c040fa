import { ACCURACY_PRESETS } from '@websplatter/core';
import type { FrameMeasurement } from '@websplatter/core/measure';
import { expect, test } from 'vitest';
import { type BenchReport, benchJson, benchText } from './bench-report.ts';

const spread = (median: number) => ({ median, low: median, high: median, p99: 1.25 * median });

const MEASUREMENT: FrameMeasurement = {
  adapter: 'a GPU',
  settings: ACCURACY_PRESETS.balanced,
  rasterizer: { rasterizer: 'tiles', reason: 'a reason' },
  widthPx: 640,
  heightPx: 360,
  frames: 20,
  loadedSplats: 200_000,
  candidateSplats: { least: 80_000, median: 90_000, most: 100_000 },
  visibleSplats: { least: 40_000, median: 50_000, most: 60_000 },
  tilePairs: { least: 1, median: 77_777, most: 100_000 },
  timing: 'gpu-timestamps',
  gpuMs: { ...spread(4), standardDeviation: 0.2 },
  wallClockMs: { ...spread(5), standardDeviation: 1 },
  stageMs: {
    preprocess: { ...spread(1), standardDeviation: 0.1 },
    sort: { ...spread(0.5), standardDeviation: 0.1 },
    rasterize: { ...spread(2), standardDeviation: 0.1 },
  },
  passes: [
    {
      part: 'pre-process',
      stage: 'cull-splats',
      dispatches: 2,
      timeMs: spread(0.1),
      bytes: { read: 8e6, written: 2e6 },
      bytesPerSecond: 1e11,
    },
    {
      part: 'pre-process',
      stage: 'plan-project',
      dispatches: 1,
      timeMs: spread(0.002),
      bytes: { read: 0, written: 0 },
      bytesPerSecond: null,
    },
    { part: 'new', stage: 'unknown', dispatches: 1, timeMs: spread(1), bytes: null, bytesPerSecond: null },
  ],
  copyBytesPerSecond: 4e11,
  memory: { totalBytes: 12.34e6, peakBytes: 23.45e6, resources: [{ label: 'planes', bytes: 12.34e6 }] },
  notes: ['something to know'],
};

const REPORT: BenchReport = {
  scene: 'scene.ply',
  isMade: false,
  shDegree: 2,
  accuracyLabel: 'balanced',
  detail: 'full',
  orbitDegrees: 15,
  load: { readMs: 100, packMs: 50.4, uploadMs: 3 },
  measurement: MEASUREMENT,
  commit: 'abc',
  machine: { cpu: 'a CPU', cpuCount: 8, memoryGiB: 32, system: 'a system', node: '20' },
};

test('the text has scene, machine, frames and passes', () => {
  expect(benchText(REPORT)).toBe(`\
scene.ply: 200,000 splats, spherical harmonics of degree 2
a GPU; 8 × a CPU, 32 GiB; a system; Node 20
commit abc

image       640×360 px, balanced, drawn by tiles (a reason); 20 frames over 15°
loading     153 ms: reading 100 ms, packing 50 ms, uploading 3 ms
visible     50,000 splats, 25.0 % (20.0 %–30.0 %); 45.0 % in visible chunks; 77,777 pairs
GPU memory  12.34 MB, at most 23.45 MB
copies      400 GB/s read and written

frame              median ms    P99  P99/median  deviation
pre-process            1.000  1.250
sort                   0.500  0.625
rasterise              2.000  2.500
whole, GPU             4.000  5.000        1.25      5.0 %
whole, wall clock      5.000  6.250        1.25     20.0 %

part         pass          ×  median ms    P99  MB read  written  GB/s  of copies
pre-process  cull-splats   2      0.100  0.125     8.00     2.00   100     25.0 %
             plan-project  1      0.002  0.003     0.00     0.00     –          –
new          unknown       1      1.000  1.250        –        –     –          –

Times are GPU timestamps, but for the wall clock’s, which runs from submission to completion.
Stages are parts of undivided frames. Passes are timed by themselves in further frames; the GPU pauses in between,
so their sum is more. MB are the least that a pass must read and write; “of copies” is GB/s as a share of the rate of copies.
note: something to know
`);
});

test('without timestamps it says so, and has only the wall clock', () => {
  const plain = { timing: 'wall-clock', gpuMs: null, stageMs: null, passes: null, tilePairs: null } as const;
  const text = benchText({ ...REPORT, commit: null, measurement: { ...MEASUREMENT, ...plain } });
  expect(text).toContain('This device has no timestamps: only the wall clock');
  expect(text).toContain('commit unknown\n');
  expect(text).toContain('whole, wall clock');
  for (const absent of ['pre-process', 'whole, GPU', 'cull-splats', 'pairs', 'NaN', 'null'])
    expect(text).not.toContain(absent);
});

test('says how much is drawn where that is less than all', () => {
  expect(benchText({ ...REPORT, detail: { maxErrorPx: 1, maxSplats: 60_000 } })).toContain(
    'detail      about 1 px of error at most, at most 60,000 splats: 50,000 splats and merged splats drawn for',
  );
  expect(benchText({ ...REPORT, detail: { maxErrorPx: 0.5 } })).toContain(
    'detail      about 0.5 px of error at most: 50,000 splats and merged splats drawn for 200,000 splats\n',
  );
});

test('says that a scene was made while it was read', () => {
  expect(benchText({ ...REPORT, isMade: true })).toContain(
    '153 ms: making and reading 100 ms, packing 50 ms',
  );
});

test('the JSON has everything', () => {
  expect(JSON.parse(benchJson(REPORT))).toEqual(REPORT);
});
