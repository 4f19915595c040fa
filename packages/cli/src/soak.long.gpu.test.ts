// Proves: the command draws, compares and sums up.
import { gpuTest } from '@websplatter/node/gpu-test';
import { expect } from 'vitest';
import { runMain } from './testing/test-folder.ts';

gpuTest('soak reports its frames, and that nothing is left of them', async () => {
  const { status, out } = await runMain('soak', '--frames', '21', '--seed', '4');
  expect(status).toBe(0);
  expect(out).toMatch(/^21 frames with seed 4 in [\d.]+ s on .+$/m);
  expect(out).toMatch(/^pictures equal to those of fresh engines, bit for bit: 1$/m);
  expect(out).toMatch(/^JavaScript heap: [\d.]+ MiB after a tenth, [\d.]+ MiB at the end$/m);
});
