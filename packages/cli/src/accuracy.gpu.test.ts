import { existsSync, readdirSync, readFileSync } from 'node:fs';
import { gpuTest } from '@websplatter/node/gpu-test';
import { expect } from 'vitest';
import { runMain, TestFolder } from './testing/test-folder.ts';

gpuTest('prints a table, writes a chart, and gives all of it as JSON', async () => {
  const folder = new TestFolder();
  const svg = folder.file('chart.svg');
  const common = ['accuracy', folder.scene(), '--camera', folder.camera(), '--size', '32x24'];
  const few = [...common, '--frames', '2', '--settings', 'shDegree'];
  const text = await runMain(...few, '--svg', svg);
  expect(text.status, text.err).toBe(0);
  expect(text.out).toMatch(/setting +PSNR dB +max error.* drawn by/);
  expect(text.out).toMatch(/> {2}balanced +\d+\.\d/);
  expect(text.out).toContain('paper −RADIUS');
  expect(text.err).toContain(' %: ');
  const chart = readFileSync(svg, 'utf8');
  expect(chart).toContain('prefers-color-scheme: dark');
  const json = await runMain(...few, '--json');
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
  for (const { name } of table.points) expect(chart).toContain(`>${name}</text>`);
  expect(readdirSync(folder.path).filter((file) => file.includes('.part'))).toEqual([]);
});

gpuTest('refuses bad input with one line, and writes nothing', async () => {
  const folder = new TestFolder();
  const [scene, camera] = [folder.scene(), folder.camera()];
  const svg = folder.file('chart.svg');
  const common = ['accuracy', scene, '--camera', camera, '--svg', svg];
  for (const [args, message] of [
    [['accuracy'], 'needs a SCENE'],
    [['accuracy', scene], 'needs --camera'],
    [common, 'needs --size'],
    [[...common, '--size', '8x8', '--base', 'best'], '--base is best'],
    [[...common, '--size', '8x8', '--settings', 'sharpness'], '“sharpness”'],
    [[...common, '--size', '8x8', '--frames', '0'], '--frames is 0'],
    [[...common, '--size', '8x8', '--sort-by', 'z'], '--sort-by is z'],
  ] as const) {
    const { status, out, err } = await runMain(...args);
    expect(err).toContain(message);
    expect(err.trimEnd()).not.toContain('\n');
    expect([status, out]).toEqual([2, '']);
  }
  expect(existsSync(svg)).toBe(false);
});
