import { expect, test } from 'vitest';
import { runMain } from './testing/test-folder.ts';

test.each([
  [['--frames', '0'], '--frames is 0'],
  [['--seed', 'x'], '--seed is x; it must be a whole number'],
  [['scene.ply'], 'soak takes no scene.ply'],
])('soak %j is bad input', async (args, message) => {
  const { status, out, err } = await runMain('soak', ...args);
  expect([status, out]).toEqual([2, '']);
  expect(err).toContain(message);
});
