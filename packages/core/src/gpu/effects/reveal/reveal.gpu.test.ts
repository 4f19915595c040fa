import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { cameraFromMatrices } from '../../../data/camera/camera.ts';
import { translated4, type Vec3 } from '../../../data/math/mat4.ts';
import { expectAsReference } from '../../../testing/expect-as-reference.ts';
import { randomSplats } from '../../../testing/random-splats.ts';
import { TEST_MODELS, testCameras } from '../../../testing/test-cameras.ts';
import { testGpu } from '../../../testing/test-gpu.ts';
import { type RevealOptions, reveal } from './reveal.ts';

const SIZE = { widthPx: 48, heightPx: 48 };
const CAMERAS = testCameras(1);
const SET = randomSplats({ count: 100, seed: 62, shDegree: 0, opacityLogits: [0, 4] });
const FLAT = Float64Array.of(1, 0.2, 0, 0, 0.1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0.1, 1);
const FROM: Vec3 = [0.3, -0.1, 0.2];

const gpu = testGpu();

describe('reveal', () => {
  for (const camera of ['perspective', 'orthographic'] as const)
    gpuTest(`from a point and from the camera, for clouds in any place, ${camera}`, async () => {
      const uses: readonly RevealOptions[] = [
        { from: FROM, radius: 0.8 },
        { from: FROM, radius: 0.9, softEdge: 0.5 },
        { from: 'camera', radius: 1.9, softEdge: 0.7 },
        { from: 'camera', radius: 2, softEdge: 5, grow: false },
        { from: FROM, radius: 0, softEdge: 0.5 },
        { from: FROM, radius: 0 },
        { from: FROM, radius: 1e6 },
      ];
      const clouds = [...Object.values(TEST_MODELS), FLAT].flatMap((modelMatrix) =>
        uses.map((options) => ({ set: SET, modelMatrix, effects: [reveal(options)] })),
      );
      clouds.push({ set: SET, modelMatrix: TEST_MODELS.identity, effects: [] });
      const drawn = await expectAsReference(gpu.device, { clouds, camera: CAMERAS[camera], ...SIZE }, 1e-5);
      const all = drawn.at(-1)!;
      for (const count of drawn.slice(0, 4)) {
        expect(count).toBeGreaterThan(3);
        expect(count).toBeLessThan(all);
      }
      expect(drawn.slice(4, 7)).toEqual([0, 0, all]);
    });

  gpuTest('distances are exact 6,400 km from the origin of the world', async () => {
    const far: Vec3 = [6.4e6, -6.4e6, 6.4e6];
    const { perspective } = CAMERAS;
    const viewMatrix = translated4(perspective.viewMatrix, [-far[0], -far[1], -far[2]]);
    const camera = cameraFromMatrices(viewMatrix, perspective.projectionMatrix, perspective);
    const from: Vec3 = [far[0] + FROM[0], far[1] + FROM[1], far[2] + FROM[2]];
    const drawFrom = (set: typeof SET, point: Vec3, seenBy: typeof camera) => {
      const band = { radius: 1.2, softEdge: 0.6 };
      const clouds = [
        { set, effects: [reveal({ ...band, from: point })] },
        { set, effects: [reveal({ ...band, from: 'camera' })] },
      ];
      return expectAsReference(gpu.device, { clouds, camera: seenBy, ...SIZE }, 1e-5);
    };
    const drawn = await drawFrom({ ...SET, origin: far }, from, camera);
    expect(drawn).toEqual(await drawFrom(SET, FROM, perspective));
  });
});
