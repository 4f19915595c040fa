// Proves: each effect and random sets of effects are drawn as in float64.
import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { beforeAll, describe, expect } from 'vitest';
import type { SplatCloud } from '../../clouds/splat-cloud.ts';
import { SplatEngine } from '../../create-engine.ts';
import type { Camera } from '../../data/camera/camera.ts';
import { compareImages, renderReference } from '../../reference/index.ts';
import { EFFECT_EXAMPLES } from '../../testing/effect-examples.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { testCameras } from '../../testing/test-cameras.ts';
import type { SplatView } from '../../views/splat-view.ts';
import type { EffectUse } from './effect.ts';

const isFull = process.env.WEBSPLATTER_FULL === '1';

const SIZE = { widthPx: 48, heightPx: 48 };
const CAMERAS = testCameras(1);
const SET = randomSplats({ count: 1200, seed: 60, shDegree: 1, logScales: [-4.5, -2] });
/** Moved, turned, stretched and sheared. */
const MODEL = [0.9, 0.3, 0, 0, -0.3, 0.8, 0.1, 0, 0.2, 0, 1.1, 0, 0.1, -0.1, 0.2, 1];

let device: GPUDevice;
let engine: SplatEngine;
let view: SplatView;
let cloud: SplatCloud;
beforeAll(async () => {
  device = await shareTestDevice();
  engine = await SplatEngine.create({ device, accuracy: 'high' });
  view = engine.createView();
  cloud = engine.add(SET);
});

async function draw(effects: readonly EffectUse[], camera: Camera): Promise<Float32Array> {
  view.render({ camera, clouds: [{ cloud, modelMatrix: MODEL, effects }], ...SIZE });
  return (await view.readPixels()).data;
}

async function psnrAgainstReference(
  effects: readonly EffectUse[],
  camera = CAMERAS.perspective,
): Promise<number> {
  const data = await draw(effects, camera);
  const reference = renderReference({ clouds: [{ set: SET, modelMatrix: MODEL, effects }], camera, ...SIZE });
  return compareImages(data, reference.data, SIZE).psnrDb;
}

describe('an effect', () => {
  for (const use of EFFECT_EXAMPLES) {
    gpuTest(`${use.effect.name}: as in float64, in perspective and orthographic views`, async () => {
      for (const camera of [CAMERAS.perspective, CAMERAS.orthographic]) {
        expect(await psnrAgainstReference([use], camera)).toBeGreaterThan(60);
        // And it is visible.
        const without = await draw([], camera);
        expect(compareImages(await draw([use], camera), without, SIZE).psnrDb).toBeLessThan(45);
      }
    });
  }
});

describe('effects together', () => {
  const sets = isFull ? 10 : 4;
  gpuTest(`${sets} random sets`, { tags: 'deeper' }, async () => {
    const random = seededRandom(7);
    for (let i = 0; i < sets; i++) {
      const some = EFFECT_EXAMPLES.filter(() => random() < 0.5);
      const names = some.map(({ effect }) => effect.name).join(', ');
      expect(await psnrAgainstReference(some, CAMERAS.inside), names).toBeGreaterThan(45);
    }
  });
});
