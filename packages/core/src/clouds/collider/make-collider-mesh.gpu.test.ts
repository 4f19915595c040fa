import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { expect } from 'vitest';
import { SplatEngine } from '../../create-engine.ts';
import { DestroyedError } from '../../data/errors.ts';
import { packCloud } from '../../data/packing/packed-cloud.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { makeColliderMesh } from './make-collider-mesh.ts';

gpuTest('a collider of a cloud on the GPU is that of the same cloud in memory', async () => {
  const engine = await SplatEngine.create({ device: await shareTestDevice() });
  const set = randomSplats({ count: 1000, seed: 4, logScales: [-4, -2] });
  const cloud = engine.add(set);
  const options = { cellSize: 0.2, fewestTriangles: 0 };
  const mesh = await makeColliderMesh(cloud, options);
  expect(mesh.indices.length).toBeGreaterThan(300);
  const inMemory = await makeColliderMesh(
    packCloud(set, { geometryPrecision: 'packed', shPrecision: 'u8' }),
    options,
  );
  expect(Array.from(mesh.indices)).toEqual(Array.from(inMemory.indices));
  expect(Array.from(mesh.positions)).toEqual(Array.from(inMemory.positions));
  cloud.destroy();
  await expect(makeColliderMesh(cloud, options)).rejects.toThrow(DestroyedError);
  engine.destroy();
});
