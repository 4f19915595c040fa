import { mkdtemp, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { basename, join } from 'node:path';
import { stillLifeCameras } from '@websplatter/scenes';
import { afterAll, beforeAll, expect, test } from 'vitest';
import { BenchError } from './bench-error.ts';
import { readScene, sceneFiles } from './scenes.ts';

/** A row of a .splat: position, scale, colour with opacity, rotation. */
function splatFile(): Uint8Array {
  const view = new DataView(new ArrayBuffer(32));
  for (let i = 0; i < 6; i++) view.setFloat32(4 * i, i < 3 ? i : 0.1, true);
  view.setUint32(24, 0xc0804020, true);
  view.setUint32(28, 0x808080ff, true);
  return new Uint8Array(view.buffer);
}

let folder = '';
beforeAll(async () => {
  folder = await mkdtemp(join(tmpdir(), 'websplatter-bench-scenes-'));
  for (const name of ['b.splat', 'a.compressed.ply', 'meta.json', 'b.cameras.json', 'notes.txt'])
    await writeFile(join(folder, name), '');
  await writeFile(join(folder, 'b.splat'), splatFile());
  await writeFile(join(folder, 'b.cameras.json'), JSON.stringify(stillLifeCameras));
});
afterAll(() => rm(folder, { recursive: true, force: true }));

test('a folder stands for the scenes in it, by their names', async () => {
  const files = await sceneFiles({ scenes: ['/x/c.ply', folder], synthetic: [] }, folder);
  expect(files.map((file) => basename(file))).toEqual(['c.ply', 'a.compressed.ply', 'b.splat']);
});

test('a folder without scenes is an error', async () => {
  const empty = await mkdtemp(join(folder, 'empty-'));
  await expect(sceneFiles({ scenes: [empty], synthetic: [] }, folder)).rejects.toThrow(BenchError);
});

test('a scene has its reader’s format, with the cameras of its name, or of its whole name', async () => {
  const file = join(folder, 'b.splat');
  const scene = await readScene(file, null);
  expect(scene).toMatchObject({
    name: 'b.splat',
    fileBytes: 32,
    format: { name: 'splat', variant: '' },
    splats: 1,
    shDegree: 0,
    cameras: stillLifeCameras,
  });
  const [first] = stillLifeCameras;
  await writeFile(`${file}.cameras.json`, JSON.stringify([first]));
  expect((await readScene(file, null)).cameras).toEqual([first]);
});
