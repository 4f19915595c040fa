import { expect, test } from 'vitest';
import { runMain } from './testing/test-folder.ts';

test.each([
  [['--filter', 'no such case'], '--filter is no such case; no case has that in its name'],
  [['--size', '64x32'], '--size is 64x32; the cases are made for squares'],
  [['--size', '0x0'], '--size is 0x0'],
  [['scale'], 'hardcases takes no scale'],
  [['--json', '--markdown'], 'two formats'],
])('hardcases %j is bad input', async (args, message) => {
  const { status, out, err } = await runMain('hardcases', ...args);
  expect([status, out]).toEqual([2, '']);
  expect(err).toContain(message);
});
