// Proves: the command draws the same as `--renderer reference`, with all options.
import { readFileSync } from 'node:fs';
import { compareImages } from '@websplatter/core/reference';
import { gpuTest } from '@websplatter/node/gpu-test';
import { expect, vi } from 'vitest';
import { runMain, TestFolder } from './testing/test-folder.ts';

vi.mock('@websplatter/node', async (original) => {
  const { withSharedDevices } = await import('./testing/shared-gpu.ts');
  return withSharedDevices(await original<typeof import('@websplatter/node')>());
});

const readRaw = (path: string) => new Float32Array(readFileSync(path).buffer.slice(0));

gpuTest('the GPU draws what the reference draws, every frame the same bits', async () => {
  const folder = new TestFolder();
  const [onGpu, onReference, timings] = ['gpu.f32', 'reference.f32', 't.json'].map((name) =>
    folder.file(name),
  );
  const scene = folder.scene();
  const size = { widthPx: 64, heightPx: 48 };
  const common = ['render', scene, scene, '--camera', folder.camera(), '--size', '64x48'];
  const model = folder.write('m.json', [0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0.25, 1]);
  common.push(
    '--model',
    model,
    '--model',
    folder.write('m1.json', [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]),
  );

  const gpu = await runMain(
    ...[...common, '--accuracy', 'reference', '--frames', '3', '--raw', onGpu, '--timings', timings],
  );
  expect(gpu.err).toMatch(/^(note: [^\n]+\n)?$/);
  expect(gpu.status).toBe(0);
  expect(gpu.out).toContain('6 of 6 splats');
  const reference = await runMain(...common, '--renderer', 'reference', '--raw', onReference);
  expect(reference.status).toBe(0);
  expect(compareImages(readRaw(onGpu), readRaw(onReference), size).psnrDb).toBeGreaterThan(60);

  const report = JSON.parse(readFileSync(timings, 'utf8'));
  expect(report).toMatchObject({ frames: 3, measuredFrames: 3, framesIdentical: true, visibleSplats: 6 });
  expect(report.stages.totalMs.median).toBeGreaterThan(0);
  expect(report.rasterizer).toMatchObject({ frames: { tiles: 3, quads: 0 }, reason: expect.any(String) });
});

gpuTest('presets and settings by name: the reference follows those that define the image', async () => {
  const folder = new TestFolder();
  const size = { widthPx: 32, heightPx: 24 };
  const common = ['render', folder.scene(), '--camera', folder.camera(), '--size', '32x24'];
  for (const [asked, minPsnrDb] of [
    [['--accuracy', 'fast'], 45],
    [['--accuracy', 'paper'], 45],
    [['--set', 'resolutionScale=1/2', '--set', 'sortKeyBits=16', '--set', 'extent=fixed'], 55],
  ] as const) {
    const [onGpu, onReference] = ['gpu.f32', 'reference.f32'].map((name) => folder.file(name));
    expect(await runMain(...common, ...asked, '--raw', onGpu)).toMatchObject({ status: 0 });
    const reference = await runMain(...common, ...asked, '--renderer', 'reference', '--raw', onReference);
    expect(reference.status).toBe(0);
    const { psnrDb } = compareImages(readRaw(onGpu), readRaw(onReference), size);
    expect(psnrDb, asked.join(' ')).toBeGreaterThan(minPsnrDb);
  }
});
