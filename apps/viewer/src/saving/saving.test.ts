import { encodePly, readSplats, type SplatSet } from '@websplatter/core';
import { expect, test } from 'vitest';
import { savedName } from './saving.ts';
import { writeScene } from './write-scene.ts';

const onePoint: SplatSet = {
  count: 1,
  origin: [0, 0, 0],
  positions: Float32Array.of(1, 2, 3),
  logScales: new Float32Array(3),
  rotations: Float32Array.of(1, 0, 0, 0),
  opacityLogits: new Float32Array(1),
  colorDc: new Float32Array(3),
  harmonics: { degree: 0, coefficients: new Float32Array() },
  fileIndices: new Uint32Array(1),
  dropped: {},
};

test.each([
  { formatName: 'spz', isUpsideDown: true, isTurned: false },
  { formatName: 'spz', isUpsideDown: false, isTurned: true },
  { formatName: 'gltf', isUpsideDown: true, isTurned: true },
  { formatName: 'gltf', isUpsideDown: false, isTurned: false },
])(
  '$formatName, upside down: $isUpsideDown, is turned: $isTurned',
  async ({ formatName, isUpsideDown, isTurned }) => {
    const source = { kind: 'file' as const, name: 'a.ply', source: new File([encodePly(onePoint)], 'a.ply') };
    const phases = new Set<string>();
    const bytes = await writeScene({ source, formatName, isUpsideDown }, ({ phase }) => phases.add(phase));
    const { positions, origin } = await readSplats(bytes);
    expect(origin.map((value, axis) => value + positions[axis])).toEqual(isTurned ? [1, -2, -3] : [1, 2, 3]);
    expect([...phases]).toEqual(['read', 'write']);
  },
);

test('built-in scenes are made again', async () => {
  const source = { kind: 'builtin' as const, name: 'still-life-small' };
  const bytes = await writeScene({ source, formatName: 'ply', isUpsideDown: true }, () => {});
  expect((await readSplats(bytes)).count).toBe(10_000);
});

test.each([
  ['garden.ply', 'garden.spz'],
  ['garden.compressed.ply', 'garden.spz'],
  ['My garden, v1.5.SPZ', 'My garden, v1.5.spz'],
  ['Still life', 'Still life.spz'],
])('%s is saved as %s', (title, name) => {
  expect(savedName(title, { extension: '.spz' })).toBe(name);
});
