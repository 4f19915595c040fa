// Proves: the command's table, JSON and chart, of settings and shares of splats.
import { readdirSync, readFileSync } from 'node:fs';
import { gpuTest } from '@websplatter/node/gpu-test';
import { expect, vi } from 'vitest';
import { runMain, TestFolder } from './testing/test-folder.ts';

vi.mock('@websplatter/node', async (original) => {
  const { withSharedDevices } = await import('./testing/shared-gpu.ts');
  return withSharedDevices(await original<typeof import('@websplatter/node')>());
});

const run = (folder: TestFolder, ...args: string[]) => {
  const common = ['accuracy', folder.scene(), '--camera', folder.camera(), '--size', '32x24'];
  return runMain(...common, '--frames', '2', '--settings', 'sortKeyBits', ...args);
};

gpuTest('accuracy prints a table', async () => {
  const text = await run(new TestFolder());
  expect(text.status, text.err).toBe(0);
  expect(text.out).toMatch(/setting +splats +PSNR dB +filtered dB +max error.* drawn by/);
  expect(text.out).toMatch(/> {2}balanced +3 +\d+\.\d/);
  expect(text.out).toContain('paper −RADIUS');
  expect(text.err).toContain(' %: ');
});

gpuTest('accuracy gives its table as JSON, and a chart of all its settings', async () => {
  const folder = new TestFolder();
  const svg = folder.file('chart.svg');
  const json = await run(folder, '--json', '--svg', svg);
  const table = JSON.parse(json.out);
  expect(table).toMatchObject({ widthPx: 32, heightPx: 24, splats: 3, frames: 2 });
  expect(table.points.length).toBeGreaterThanOrEqual(8);
  const [base, reference] = table.points;
  for (const { name, settings, rasterizers } of table.points) {
    if (settings.rasterizer !== 'auto') expect(rasterizers, name).toEqual([settings.rasterizer]);
    expect(rasterizers.length, name).toBeGreaterThan(0);
  }
  expect(base.error.psnrDb).toBeGreaterThan(30);
  expect(reference).toMatchObject({ name: 'reference', error: { psnrDb: null, maxError: 0 } });
  const chart = readFileSync(svg, 'utf8');
  expect(chart).toContain('prefers-color-scheme: dark');
  for (const { name } of table.points) expect(chart).toContain(`>${name}</text>`);
  expect(readdirSync(folder.path).filter((file) => file.includes('.part'))).toEqual([]);
});

gpuTest('accuracy measures fewer splats, from farther, against filtered pictures', async () => {
  const camera = new TestFolder().camera('camera.json', { position: [0, 0.5, 1.5] });
  const common = ['accuracy', 'builtin:still-life-small', '--camera', camera, '--size', '32x24'];
  const options = ['--frames', '1', '--settings', 'sortKeyBits', '--json', '--base', 'reference'];
  const run = async (...args: string[]) => {
    const { status, out, err } = await runMain(...common, ...options, ...args);
    expect(status, err).toBe(0);
    return JSON.parse(out);
  };
  const far = await run('--details', '50,6', '--distance', '4');
  const [half, few] = far.points.slice(-2);
  expect([half.name, few.name]).toEqual(['50 % of splats', '6 % of splats']);
  expect(half.detail).toEqual({ maxShare: 0.5 });
  expect(half.splats).toBeGreaterThan(few.splats);
  expect(half.splats).toBeLessThanOrEqual(5000);
  expect(half.error.psnrDb).toBeGreaterThan(few.error.psnrDb);
  for (const { filteredPsnrDb, error } of far.points) {
    expect(filteredPsnrDb).toBeGreaterThan(5);
    expect(filteredPsnrDb).not.toBe(error.psnrDb);
  }
  const near = await run('--details', 'none');
  expect([near.distance, far.distance]).toEqual([1, 4]);
  for (const { detail, filteredPsnrDb, splats } of near.points) {
    expect([detail, filteredPsnrDb]).toEqual(['full', null]);
    // From farther away, more are in sight.
    expect(splats).toBeLessThan(far.points[0].splats);
  }
});
