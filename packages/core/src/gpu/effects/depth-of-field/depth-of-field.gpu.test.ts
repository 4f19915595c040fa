import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { SplatEngine } from '../../../create-engine.ts';
import { orthographicCamera, perspectiveCamera } from '../../../data/camera/camera.ts';
import { compareImages, renderReference } from '../../../reference/index.ts';
import { expectAsReference } from '../../../testing/expect-as-reference.ts';
import { randomSplats, splatsOf } from '../../../testing/random-splats.ts';
import { testCameras } from '../../../testing/test-cameras.ts';
import { testGpu } from '../../../testing/test-gpu.ts';
import { antialias } from '../antialias/antialias.ts';
import { type DepthOfFieldOptions, depthOfField } from './depth-of-field.ts';

const SIZE = { widthPx: 48, heightPx: 48 };
const SET = randomSplats({ count: 150, seed: 71, shDegree: 0, logScales: [-5, -1] });
const CAMERAS = {
  // Pixels are no squares: circles of confusion are ellipses.
  ...testCameras(1.3),
  'orthographic, with splats behind the camera': orthographicCamera({
    position: [0, 0, 0],
    target: [0.2, 0.1, -1],
    height: 2,
    aspect: 1,
    near: -10,
  }),
};
const LENSES: readonly DepthOfFieldOptions[] = [
  { aperture: 0.05, focusDistance: 1.8 },
  { aperture: 0.3, focusDistance: 1 },
  { aperture: 1e-30, focusDistance: 1e-30 },
  { aperture: 1e30, focusDistance: 1e30 },
];

const gpu = testGpu();

describe('depth of field', () => {
  for (const [name, camera] of Object.entries(CAMERAS))
    gpuTest(`every splat is as in float64, ${name}`, async () => {
      const uses = [
        ...LENSES.map((options) => [depthOfField(options)]),
        [antialias(), depthOfField({ aperture: 0.1, focusDistance: 2 })],
      ];
      const clouds = uses.map((effects) => ({ set: SET, effects }));
      const counts = await expectAsReference(gpu.device, { clouds, camera, ...SIZE }, 5e-5);
      expect(counts[0]).toBeGreaterThan(20);
    });

  gpuTest('huge, flat and tiny splats are as in float64', async () => {
    const set = splatsOf([
      { logScales: [30, 30, 30] },
      { logScales: [10, -4, -4], rotation: [0.8, 0.3, -0.4, 0.33] },
      { logScales: [-1, -100, -100] },
      { logScales: [-100, -100, -100] },
    ]);
    const clouds = [{ set, effects: [depthOfField({ aperture: 0.2, focusDistance: 3 })] }];
    await expectAsReference(gpu.device, { clouds, camera: testCameras(1).perspective, ...SIZE }, 5e-5);
  });

  gpuTest('chunks beside the image are drawn if their blur reaches into it', async () => {
    const camera = perspectiveCamera({ position: [0, 0, 3], target: [0, 0, 0], fovYDegrees: 40, aspect: 1 });
    const beside = { ...SET, positions: SET.positions.map((value, i) => (i % 3 === 0 ? 1.35 : value / 4)) };
    const effects = [depthOfField({ aperture: 0.6, focusDistance: 1 })];
    const engine = await SplatEngine.create({ device: gpu.device, accuracy: 'high' });
    const view = engine.createView();
    view.render({ camera, clouds: [{ cloud: engine.add(beside), effects }], ...SIZE });
    const { data } = await view.readPixels();
    const reference = renderReference({ clouds: [{ set: beside, effects }], camera, ...SIZE });
    expect(Math.max(...reference.data)).toBeGreaterThan(0.05);
    expect(compareImages(data, reference.data, SIZE).psnrDb).toBeGreaterThan(60);
    engine.destroy();
  });
});
