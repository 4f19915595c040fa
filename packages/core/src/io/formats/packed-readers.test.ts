import { gzipSync } from 'node:zlib';
import { describe, expect, test } from 'vitest';
import { fileErrorOf } from '../../testing/file-error-of.ts';
import { glbBytes, gltfBytes, gltfOf, splatAttributes } from '../../testing/gltf-fixture.ts';
import { plyBytes, splatElement } from '../../testing/ply-fixture.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { zipBytes } from '../../testing/zip-fixture.ts';
import { readSource } from '../loading/read-source.ts';
import { knownSource } from '../sources/known-source.ts';
import { ALL_READERS } from './readers.ts';
import { distinctSplat, spzBytes } from './spz/spz-fixture.ts';

const gltf = gltfOf(splatAttributes(randomSplats({ count: 3, shDegree: 1 })));
const spz = spzBytes({ version: 4, degree: 1, splats: [0, 1].map((row) => distinctSplat(4, 1, row)) });
const points =
  'ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n';
const FILES: readonly (readonly [name: string, bytes: Uint8Array])[] = [
  ['scene.ply', plyBytes({ format: 'binary_little_endian', elements: [splatElement(5)] })],
  [
    'points.ply',
    Buffer.from(
      `${points}property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n1 2 3 4 5 6\n`,
    ),
  ],
  ['scene.spz', spz],
  ['scene.glb', glbBytes(gltf)],
  ['scene.splat', new Uint8Array(Float32Array.from({ length: 24 }, (_, i) => 0.1 + i).buffer)],
];

const read = (bytes: Uint8Array, name: string) =>
  readSource(knownSource(Uint8Array.from(bytes), { name }), { shPrecision: 'f32' }, ALL_READERS);

describe.each(FILES)('%s', (name, bytes) => {
  test('packed by gzip, under any name where the bytes tell the format', async () => {
    const alone = await read(bytes, name);
    expect(await read(gzipSync(bytes), `${name}.gz`)).toEqual(alone);
    if (!name.endsWith('.splat')) expect(await read(gzipSync(bytes), 'scene')).toEqual(alone);
  });

  test('in a zip archive', async () => {
    const zip = zipBytes({ 'a/read.me': Buffer.from('x'), [`a/${name}`]: bytes }, { isDeflated: true });
    expect(await read(zip, 'scene.zip')).toEqual(await read(bytes, name));
  });
});

test('a glTF finds its buffer in its archive', async () => {
  const { fileFacts: _, ...whole } = await read(glbBytes(gltf), 'scene.glb');
  const zip = zipBytes({ 'a/scene.gltf': gltfBytes(gltf, 'scene.bin'), 'a/scene.bin': gltf.binary });
  expect(await read(zip, 'scene.zip')).toMatchObject(whole);
});

test('packed files without a scene are refused', async () => {
  const gzip = await fileErrorOf(read(gzipSync('hello'), 'hello.gz'));
  expect(gzip).toMatchObject({
    code: 'unknown-format',
    message: expect.stringContaining('none of PLY, SPZ'),
  });
  const zip = await fileErrorOf(read(zipBytes({ 'a.ply': Buffer.from('hello') }), 'hello.zip'));
  expect(zip).toMatchObject({
    code: 'unknown-format',
    message: expect.stringContaining('with a.ply; only SOG'),
  });
});
