import { createTestDevice, gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { beforeAll, describe, expect } from 'vitest';
import { SplatEngine } from '../create-engine.ts';
import type { Camera } from '../data/camera/camera.ts';
import { randomSplats } from '../testing/random-splats.ts';
import { testCameras } from '../testing/test-cameras.ts';
import type { Detail } from './frame-request.ts';

const SIZE = { widthPx: 160, heightPx: 120 };
const set = randomSplats({ count: 20000, seed: 7, shDegree: 1, logScales: [-6, -4] });
let engine: SplatEngine;
beforeAll(async () => {
  engine = await SplatEngine.create({ device: await shareTestDevice(), accuracy: 'reference' });
});

describe('levels', () => {
  gpuTest('trial', async () => {
    const cloud = engine.add(set);
    const view = engine.createView();
    const camera = testCameras(1).perspective;
    const draw = async (detail: Detail) => {
      view.render({ camera, clouds: [{ cloud }], ...SIZE, detail });
      const { data } = await view.readPixels();
      return { data, visible: view.statistics?.visibleSplats };
    };
    const full = await draw('full');
    await cloud.makeLevels();
    for (const maxErrorPx of [0, 0.1, 0.5, 1, 2, 4, 100]) {
      const { data, visible } = await draw({ maxErrorPx });
      let sum = 0;
      for (const [i, value] of data.entries()) sum += (value - full.data[i]) ** 2;
      console.log(maxErrorPx, visible, -10 * Math.log10(sum / data.length));
    }
  });
});
