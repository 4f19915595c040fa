import { readFile } from 'node:fs/promises';
import { readSplats } from '@websplatter/core';
import { expect, test } from 'vitest';
import { builtinScenes } from './builtin-scenes.ts';

test.each(builtinScenes)(
  '$name is a file of $splats splats of degree 3, none of which is dropped',
  async ({ url, splats }) => {
    const set = await readSplats(new Blob([await readFile(url)]));
    expect(set).toMatchObject({ count: splats, harmonics: { degree: 3 }, dropped: {} });
  },
);

test.each(builtinScenes)('the file of $name has at most 3 MB', async ({ url }) => {
  expect((await readFile(url)).byteLength).toBeLessThanOrEqual(3e6);
});

test('scenes and their cameras have names of their own', () => {
  const names = builtinScenes.map(({ name }) => name);
  expect(new Set(names).size).toBe(names.length);
  for (const { cameras } of builtinScenes)
    expect(new Set(cameras.map(({ name }) => name)).size).toBe(cameras.length);
});
