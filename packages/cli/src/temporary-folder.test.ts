import { readdirSync } from 'node:fs';
import { expect, test } from 'vitest';
import { TemporaryFolder } from './temporary-folder.ts';
import { TestFolder } from './testing/test-folder.ts';

test('a temporary file has no name, and keeps what is written anywhere in it', async () => {
  const { path } = new TestFolder();
  const file = await new TemporaryFolder(path).makeFile(8);
  expect(readdirSync(path)).toEqual([]);
  await Promise.all([file.write(Uint8Array.of(5, 6), 4), file.write(Uint8Array.of(1, 2, 3, 4), 0)]);
  expect(await file.read(1, 5)).toEqual(Uint8Array.of(2, 3, 4, 5, 6));
  await expect(file.read(4, 3)).rejects.toThrow('is shorter than it was');
  await file.remove();
});

test('a folder without room is refused by name', async () => {
  const { path } = new TestFolder();
  const message = /GB free, and temporary data take 1000000000\.0 GB; make room, or name another folder/;
  await expect(new TemporaryFolder(path).makeFile(1e18)).rejects.toThrow(message);
});
