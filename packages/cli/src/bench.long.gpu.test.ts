// Proves: the command's tables and JSON, of a file and of a synthetic scene.
import { gpuTest } from '@websplatter/node/gpu-test';
import { expect, onTestFinished, vi } from 'vitest';
import { runMain, TestFolder } from './testing/test-folder.ts';

vi.mock('@websplatter/node', async (original) => {
  const { withSharedDevices } = await import('./testing/shared-gpu.ts');
  return withSharedDevices(await original<typeof import('@websplatter/node')>());
});

/** Size of the copies that measure bandwidth. One test takes the default, which takes software seconds. */
let copyBytes: number | undefined;
vi.mock('@websplatter/core/measure', async (original) => {
  const module = await original<typeof import('@websplatter/core/measure')>();
  const measureFrames: typeof module.measureFrames = (engine, options) =>
    module.measureFrames(engine, { ...options, copyBytes });
  return { ...module, measureFrames };
});

const SMALL = ['--size', '48x32', '--frames', '2', '--set', 'rasterizer=tiles'];

gpuTest('measures a file and prints tables', async () => {
  copyBytes = 2 ** 20;
  onTestFinished(() => {
    copyBytes = undefined;
  });
  const folder = new TestFolder();
  const { status, out, err } = await runMain('bench', folder.scene(), '--camera', folder.camera(), ...SMALL);
  expect(err).not.toContain('failed');
  expect(status).toBe(0);
  expect(out).toMatch(/^\S+scene\.ply: 3 splats, spherical harmonics of degree 1\n/);
  expect(out).toContain('48×32 px, balanced rasterizer=tiles, drawn by tiles');
  expect(out).toMatch(/whole, wall clock +\d+\.\d{3}/);
  expect(out).not.toMatch(/NaN|Infinity|undefined/);
  expect(err).toContain('0 %: Warming up\n');
});

gpuTest('measures a synthetic scene from its own camera, as JSON', async () => {
  const { status, out, err } = await runMain(
    'bench',
    '--synthetic',
    '10k',
    '--degree',
    '1',
    '--json',
    ...SMALL,
  );
  expect(status, err).toBe(0);
  const report = JSON.parse(out);
  expect(report).toMatchObject({ shDegree: 1, orbitDegrees: 15, machine: { node: process.versions.node } });
  const { measurement, load } = report;
  expect(measurement).toMatchObject({ loadedSplats: 10_000, frames: 2, widthPx: 48, heightPx: 32 });
  expect(measurement.visibleSplats.least).toBeGreaterThan(1000);
  expect(measurement.wallClockMs.median).toBeGreaterThan(0);
  expect(Object.values<number>(load).every((ms) => ms >= 0)).toBe(true);
  expect(load.readMs).toBeGreaterThan(0);
  if (measurement.timing === 'gpu-timestamps') {
    const stages = measurement.passes.map(({ stage }: { stage: string }) => stage);
    expect(stages).toEqual(
      expect.arrayContaining(['cull-chunks', 'project', 'sort-scatter', 'tile-rasterize']),
    );
  }
});

gpuTest('refuses bad input with one line', async () => {
  const folder = new TestFolder();
  for (const [args, message] of [
    [['bench'], 'needs one SCENE'],
    [['bench', folder.scene(), '--up', 'w'], '--up is w'],
    [['bench', '--synthetic', '5'], '--synthetic is 5'],
    [['bench', folder.file('none.ply'), '--camera', folder.camera()], 'there is no such file'],
    [['bench', folder.write('bad.ply', 'hello'), '--camera', folder.camera()], 'bad.ply'],
    [['bench', folder.scene(), '--camera', folder.file('none.json')], 'none.json'],
  ] as const) {
    const { status, out, err } = await runMain(...args);
    expect(err).toContain(message);
    expect(err.trimEnd()).not.toContain('\n');
    expect([status, out]).toEqual([2, '']);
  }
});
