// Proves: presets are in the order of their error against float64.
import { readFile } from 'node:fs/promises';
import { perspectiveCamera, readSplats, type SplatEngine } from '@websplatter/core';
import { cropSplats, limitDegree, transformSplats } from '@websplatter/core/write';
import { gpuTest } from '@websplatter/node/gpu-test';
import { builtinScenes } from '@websplatter/scenes';
import { afterAll, beforeAll, describe } from 'vitest';
import { expectPresets, expectPresetsOfObject, IS_FULL, referenceEngine } from './testing/expect-presets.ts';

/**
 * Compares every preset with float64 and with the reference image of the terminal and the viewer.
 * `npm run test:full` adds the whole built-in scene, and larger images.
 */

const scene = builtinScenes.find(({ name }) => name === (IS_FULL ? 'still-life' : 'still-life-small'))!;
const readScene = async () => readSplats(new Blob([await readFile(scene.url)]), { shPrecision: 'f32' });

let engine: SplatEngine;
beforeAll(async () => {
  engine = await referenceEngine();
});
afterAll(() => engine?.destroy());

describe('presets against float64', () => {
  gpuTest(
    'the built-in scene',
    async () => {
      const camera = perspectiveCamera({ ...scene.cameras[0], aspect: 1 });
      return expectPresets(engine, await readScene(), camera);
    },
    600_000,
  );

  gpuTest(
    'an object alone, of degree 2 and y down, as captures are',
    async () => {
      const still = limitDegree(await readScene(), 2);
      const object = cropSplats(still, { min: [-0.6, -0.3, -0.6], max: [0.6, 0.9, 0.6] });
      const turned = transformSplats(object, {
        rotation: [0, 1, 0, 0],
        scale: 1.6,
        translation: [0, 0.7, 0],
      });
      return expectPresetsOfObject(engine, turned);
    },
    600_000,
  );
});
