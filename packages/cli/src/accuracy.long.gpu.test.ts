import { readdirSync, readFileSync } from 'node:fs';
import { gpuTest } from '@websplatter/node/gpu-test';
import { expect } from 'vitest';
import { runMain, TestFolder } from './testing/test-folder.ts';

const run = (folder: TestFolder, ...args: string[]) => {
  const common = ['accuracy', folder.scene(), '--camera', folder.camera(), '--size', '32x24'];
  return runMain(...common, '--frames', '2', '--settings', 'sortKeyBits', ...args);
};

gpuTest('accuracy prints a table', async () => {
  const text = await run(new TestFolder());
  expect(text.status, text.err).toBe(0);
  expect(text.out).toMatch(/setting +PSNR dB +max error.* drawn by/);
  expect(text.out).toMatch(/> {2}balanced +\d+\.\d/);
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
