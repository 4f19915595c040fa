import { gpuTest } from '@websplatter/node/gpu-test';
import { expect, test } from 'vitest';
import { runMain } from './testing/test-folder.ts';

gpuTest('soak says what it drew, and that nothing is left of it', async () => {
  const { status, out } = await runMain('soak', '--frames', '21', '--seed', '4');
  expect(status).toBe(0);
  expect(out).toMatch(/^21 frames with seed 4 in [\d.]+ s on .+$/m);
  expect(out).toMatch(
    /^pictures equal to those of fresh engines, bit for bit: 1; only when drawn anew, without kept colours: \d$/m,
  );
  expect(out).toMatch(/^JavaScript heap: [\d.]+ MiB after a tenth, [\d.]+ MiB at the end$/m);
});

test.each([
  [['--frames', '0'], '--frames is 0'],
  [['--seed', 'x'], '--seed is x; it must be a whole number'],
  [['scene.ply'], 'soak takes no scene.ply'],
])('soak %j is bad input', async (args, message) => {
  const { status, out, err } = await runMain('soak', ...args);
  expect([status, out]).toEqual([2, '']);
  expect(err).toContain(message);
});
