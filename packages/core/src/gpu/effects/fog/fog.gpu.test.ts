import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { orthographicCamera } from '../../../data/camera/camera.ts';
import { expectAsReference } from '../../../testing/expect-as-reference.ts';
import { randomSplats } from '../../../testing/random-splats.ts';
import { testCameras } from '../../../testing/test-cameras.ts';
import { testGpu } from '../../../testing/test-gpu.ts';
import { type FogOptions, fog } from './fog.ts';

const SIZE = { widthPx: 48, heightPx: 48 };
const SET = randomSplats({ count: 150, seed: 63, shDegree: 1 });
const CAMERAS = {
  perspective: testCameras(1).perspective,
  orthographic: testCameras(1).orthographic,
  // In the middle of the cloud, half of which has a negative depth.
  'orthographic, with splats behind the camera': orthographicCamera({
    position: [0, 0, 0],
    target: [0.2, 0.1, -1],
    height: 2,
    aspect: 1,
    near: -10,
  }),
};
const FOGS: readonly FogOptions[] = [
  { color: [0.5, 0.6, 0.8], near: 0.5, far: 2.5 },
  { color: [1, 0, 0.02], near: -0.5, far: 0.5 },
  // As abrupt as a wall: in float32 the two depths are equal.
  { color: [2, 0.3, 0], near: 1.5, far: 1.5 + 1e-12 },
  { color: [0.5, 0.6, 0.8], density: 0.4 },
  { color: [0.5, 0.6, 0.8], density: 1e30 },
];

const gpu = testGpu();

describe('fog', () => {
  for (const [name, camera] of Object.entries(CAMERAS))
    gpuTest(`between depths and of a density, ${name}`, async () => {
      const clouds = FOGS.map((options) => ({ set: SET, effects: [fog(options)] }));
      const drawn = await expectAsReference(gpu.device, { clouds, camera, ...SIZE }, 2e-5);
      for (const count of drawn) expect(count).toBeGreaterThan(50);
    });
});
