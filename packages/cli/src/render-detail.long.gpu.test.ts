import { readFileSync } from 'node:fs';
import { gpuTest } from '@websplatter/node/gpu-test';
import { expect, vi } from 'vitest';
import { runMain, TestFolder } from './testing/test-folder.ts';

vi.mock('@websplatter/node', async (original) => {
  const { withSharedDevices } = await import('./testing/shared-gpu.ts');
  return withSharedDevices(await original<typeof import('@websplatter/node')>());
});

gpuTest('less than full detail draws fewer splats', async () => {
  const folder = new TestFolder();
  const camera = folder.camera('far.json', { position: [0, 1, 8] });
  const timings = folder.file('t.json');
  const visible = async (...detail: string[]) => {
    const common = ['render', 'builtin:still-life-small', '--camera', camera, '--size', '64x48'];
    const run = await runMain(...[...common, '--raw', folder.file('a.f32'), '--timings', timings, ...detail]);
    expect(run.status, run.err).toBe(0);
    return { out: run.out, ...JSON.parse(readFileSync(timings, 'utf8')) };
  };
  const full = await visible();
  expect(full.detail).toBe('full');
  expect(full.out).not.toContain('detail');
  const less = await visible('--detail', 'maxErrorPx=1');
  expect(less.detail).toEqual({ maxErrorPx: 1 });
  expect(less.out).toMatch(
    /^detail: about 1 px of error at most: [\d,]+ splats and merged splats drawn for 10,000 splats$/m,
  );
  expect(less.visibleSplats).toBeLessThan(full.visibleSplats);
  const few = await visible('--detail', 'maxSplats=5000');
  expect(few.visibleSplats).toBeLessThanOrEqual(5000);
  // Those count, too, that reach into the image by less than their bounds.
  expect(few.visibleSplats).toBeGreaterThan(4500);
});
