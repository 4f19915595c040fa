import { mkdtemp, readdir, readFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { beforeEach, expect, test } from 'vitest';
import { checkWritable, writeFiles } from './output-files.ts';

let folder: string;
beforeEach(async () => {
  folder = await mkdtemp(join(tmpdir(), 'websplatter-'));
});

test('files are written whole, over older ones, with nothing left beside them', async () => {
  const path = join(folder, 'a.txt');
  await writeFiles([{ path, content: 'old' }]);
  await writeFiles([{ path, content: 'new' }]);
  expect(await readFile(path, 'utf8')).toBe('new');
  expect(await readdir(folder)).toEqual(['a.txt']);
});

test('where one file cannot be written none is', async () => {
  const path = join(folder, 'missing', 'b.txt');
  const writing = writeFiles([
    { path: join(folder, 'a.txt'), content: 'a' },
    { path, content: 'b' },
  ]);
  await expect(writing).rejects.toThrow(`${path}: cannot be written: there is no such file or folder`);
  expect(await readdir(folder)).toEqual([]);
});

test('a path that cannot become a file is refused beforehand', async () => {
  await expect(checkWritable(folder)).rejects.toThrow('it is a folder');
  await expect(checkWritable(join(folder, 'no', 'a.png'))).rejects.toThrow(`(folder ${join(folder, 'no')})`);
  await expect(checkWritable(join(folder, 'a.png'))).resolves.toBeUndefined();
});
