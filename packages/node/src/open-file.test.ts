import { mkdir, mkdtemp, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import type { SceneFiles } from '@websplatter/core';
import { afterAll, beforeAll, expect, test } from 'vitest';
import { openFile } from './open-file.ts';

let folder: string;
beforeAll(async () => {
  folder = await mkdtemp(join(tmpdir(), 'websplatter-open-file-'));
  await mkdir(join(folder, 'scene/parts'), { recursive: true });
  await mkdir(join(folder, 'empty'));
  await writeFile(join(folder, 'a.ply'), 'twelve bytes');
  await writeFile(join(folder, 'scene/scene.gltf'), '{}');
  await writeFile(join(folder, 'scene/parts/a.bin'), 'part');
});
afterAll(() => rm(folder, { recursive: true, force: true }));

const textOf = (blob: Blob) => new Response(blob.stream()).text();

test('a file can be read again and again, and has a name and a size', async () => {
  const file = (await openFile(join(folder, 'a.ply'))) as File;
  expect(file).toMatchObject({ name: 'a.ply', size: 12 });
  for (let i = 0; i < 2; i++) expect(await textOf(file)).toBe('twelve bytes');
});

test.each(['scene/scene.gltf', 'scene'])('%s comes with the files that it leads to', async (path) => {
  const { files, paths } = (await openFile(join(folder, path))) as SceneFiles;
  expect(paths).toEqual(['scene.gltf', 'parts/a.bin']);
  expect(await Promise.all(files.map(textOf))).toEqual(['{}', 'part']);
});

test.each([
  ['empty', 'EISDIR'],
  ['none.ply', 'ENOENT'],
])('%s is %s', async (path, code) => {
  await expect(openFile(join(folder, path))).rejects.toMatchObject({ code });
});
