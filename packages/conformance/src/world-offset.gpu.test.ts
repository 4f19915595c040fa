// Proves: splats far from the origin look as they do at the origin.
import { type AccuracyPreset, SplatEngine } from '@websplatter/core';
import { compareImages } from '@websplatter/core/reference';
import { gpuTest, sharedTestGpu, watchDevice } from '@websplatter/node/gpu-test';
import { afterAll, describe, expect } from 'vitest';
import { WORLD_CASES } from './groups/world.ts';
import type { SceneCase } from './hard-case.ts';

const SIZE = { widthPx: 64, heightPx: 64 };
const MIN_PSNR_DB = 45;

const engines: SplatEngine[] = [];
afterAll(() => {
  for (const engine of engines) engine.destroy();
});

/** Draws an image with each of the case's cameras. */
async function imagesOf(engine: SplatEngine, caseName: string): Promise<Float32Array[]> {
  const hardCase = WORLD_CASES.find(({ name }) => name === caseName) as SceneCase;
  const clouds = await Promise.all(
    hardCase.clouds().map(async ({ modelMatrix, ...splats }) => ({
      cloud: 'file' in splats ? await engine.load(splats.file) : engine.add(splats.set),
      modelMatrix,
    })),
  );
  const view = engine.createView();
  const images: Float32Array[] = [];
  for (const camera of Object.values(hardCase.cameras(1))) {
    view.render({ camera, clouds, ...SIZE });
    images.push((await view.readPixels()).data);
  }
  view.destroy();
  for (const { cloud } of clouds) cloud.destroy();
  return images;
}

describe('millimetres 6.4e6 m away look like the same millimetres at the origin', () => {
  for (const accuracy of ['reference', 'high', 'balanced'] satisfies AccuracyPreset[]) {
    gpuTest(accuracy, async () => {
      const adapter = await sharedTestGpu.requestAdapter();
      const engine = await SplatEngine.create({ adapter, accuracy });
      engines.push(engine);
      watchDevice(engine.device);
      const atOrigin = await imagesOf(engine, 'world-millimetres-at-the-origin');
      for (const name of ['world-offset-6-4e6-by-model-matrix', 'world-offset-6-4e6-by-double-properties']) {
        for (const [i, image] of (await imagesOf(engine, name)).entries()) {
          const { psnrDb } = compareImages(image, atOrigin[i], SIZE);
          expect(psnrDb, `${name}, camera ${i}`).toBeGreaterThan(MIN_PSNR_DB);
        }
      }
    });
  }
});
