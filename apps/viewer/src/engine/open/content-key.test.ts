import { builtinScenes } from '@websplatter/scenes';
import { expect, test } from 'vitest';
import { contentKeyOf } from './content-key.ts';

const file = (bytes: Uint8Array<ArrayBuffer> | string, name = 'point_cloud.ply') => ({
  kind: 'file' as const,
  name,
  source: new File([bytes], name),
});

test('files of one name that hold something else have other keys; copies have the same', async () => {
  const bytes = new Uint8Array(3 << 20);
  const key = await contentKeyOf(file(bytes));
  expect(await contentKeyOf(file(bytes, 'copy.ply'))).toBe(key);
  expect(await contentKeyOf(file(bytes.with(100, 1)))).not.toBe(key);
  // Both the first megabyte and the size count.
  expect(await contentKeyOf(file(bytes.slice(1)))).not.toBe(key);
});

test('empty files have a key, and so have files that have gone', async () => {
  expect(await contentKeyOf(file(''))).toMatch(/^file:0:/);
  const gone = new File(['a'], 'a.ply');
  gone.slice = () => {
    throw new DOMException('The file has gone.', 'NotFoundError');
  };
  expect(await contentKeyOf({ kind: 'file', name: 'a.ply', source: gone })).toBe('name:a.ply');
});

test('scenes of several files are told apart by all sizes and by what describes them', async () => {
  const scene = (json: string, image: string, paths?: string[]) => ({
    kind: 'file' as const,
    name: 'scene',
    source: {
      files: [new File([image], 'means_l.webp'), new File([json], 'meta.json')],
      ...(paths && { paths }),
    },
  });
  const key = await contentKeyOf(scene('{"a":1}', 'image'));
  expect(await contentKeyOf(scene('{"a":1}', 'image'))).toBe(key);
  for (const other of [
    scene('{"a":2}', 'image'),
    scene('{"a":1}', 'images'),
    scene('{"a":1}', 'image', ['x.webp', 'meta.json']),
  ])
    expect(await contentKeyOf(other)).not.toBe(key);
});

test('addresses name what they hold, whatever part of the page they point to', async () => {
  const at = (url: string) => contentKeyOf({ kind: 'url', url: new URL(url) });
  expect(await at('https://a.test/1/scene.ply#top')).toBe('https://a.test/1/scene.ply');
  expect(await at('https://a.test/2/scene.ply')).not.toBe(await at('https://a.test/1/scene.ply'));
});

test('built-in scenes and hard cases have keys of their own', async () => {
  const keys = await Promise.all([
    ...builtinScenes.map((scene) => contentKeyOf({ kind: 'builtin', scene })),
    contentKeyOf({ kind: 'hard-case', name: builtinScenes[0].name }),
  ]);
  expect(new Set(keys).size).toBe(keys.length);
});
