import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { cameraFromMatrices } from '../../../data/camera/camera.ts';
import { translated4, type Vec3 } from '../../../data/math/mat4.ts';
import { expectAsReference } from '../../../testing/expect-as-reference.ts';
import { randomSplats } from '../../../testing/random-splats.ts';
import { TEST_MODELS, testCameras } from '../../../testing/test-cameras.ts';
import { testGpu } from '../../../testing/test-gpu.ts';
import { type ClipVolume, clip } from './clip.ts';

const SIZE = { widthPx: 48, heightPx: 48 };
const CAMERA = testCameras(1).perspective;
const SET = randomSplats({ count: 100, seed: 61, shDegree: 0, opacityLogits: [0, 4] });
const FLAT = Float64Array.of(1, 0.2, 0, 0, 0.1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0.1, 1);
const MODELS = [...Object.values(TEST_MODELS), FLAT];

const SHAPES: readonly ClipVolume[] = [
  { shape: 'box', center: [0.2, 0.1, 0], size: [1, 0.8, 1.4], rotation: [0.3, -0.2, 0.4, 0.9] },
  { shape: 'sphere', center: [0, 0.2, 0.3], radius: 0.7 },
  { shape: 'plane', point: [0.1, 0, 0.1], normal: [0.2, -3, 1] },
];
const VOLUMES = SHAPES.flatMap((volume) => [volume, { ...volume, keep: 'outside' } as const]);

const gpu = testGpu();

describe('clip', () => {
  gpuTest('every shape and side, soft and hard, for clouds in any place', async () => {
    const clouds = MODELS.flatMap((modelMatrix, i) =>
      VOLUMES.map((volume, j) => ({
        set: SET,
        modelMatrix,
        effects: [clip({ volumes: [volume], softEdge: (i + j) % 2 === 0 ? 0.3 : 0 })],
      })),
    );
    const drawn = await expectAsReference(gpu.device, { clouds, camera: CAMERA, ...SIZE }, 1e-5);
    const most = await expectAsReference(
      gpu.device,
      { clouds: [{ set: SET }], camera: CAMERA, ...SIZE },
      1e-5,
    );
    for (const count of drawn.slice(0, VOLUMES.length)) {
      expect(count).toBeGreaterThan(3);
      expect(count).toBeLessThan(most[0] - 3);
    }
  });

  gpuTest('each of eight volumes cuts, and volumes that contain nothing leave nothing', async () => {
    // Each removes one corner of the cloud.
    const corners = [-1, 1].flatMap((x) => [-1, 1].flatMap((y) => [-1, 1].map((z): Vec3 => [x, y, z])));
    const volumes = corners.map((normal): ClipVolume => {
      const point = normal.map((coordinate) => coordinate * -0.3) as unknown as Vec3;
      return { shape: 'plane', point, normal };
    });
    const empty: readonly ClipVolume[] = [
      { shape: 'sphere', center: [0, 0, 0], radius: 0 },
      { shape: 'box', center: [0, 0, 0], size: [2, 2, 0] },
    ];
    const clouds = [
      ...volumes.map((_, last) => ({ set: SET, effects: [clip({ volumes: volumes.slice(0, last + 1) })] })),
      ...empty.map((volume) => ({ set: SET, effects: [clip({ volumes: [volume] })] })),
      ...empty.map((volume) => ({
        set: SET,
        effects: [clip({ volumes: [{ ...volume, keep: 'outside' }] })],
      })),
      { set: SET },
    ];
    const drawn = await expectAsReference(gpu.device, { clouds, camera: CAMERA, ...SIZE }, 1e-5);
    const all = drawn.at(-1)!;
    for (let i = 1; i < 8; i++) expect(drawn[i]).toBeLessThan(drawn[i - 1]);
    expect(drawn[7]).toBeGreaterThan(0);
    expect(drawn.slice(8)).toEqual([0, 0, all, all, all]);
  });

  gpuTest('edges stay in place 6,400 km from the origin of the world', async () => {
    const far: Vec3 = [6.4e6, -6.4e6, 6.4e6];
    const moved = ([x, y, z]: Vec3): Vec3 => [x + far[0], y + far[1], z + far[2]];
    const clouds = SHAPES.map((volume) => ({
      set: { ...SET, origin: far },
      effects: [
        clip({
          volumes: [
            volume.shape === 'plane'
              ? { ...volume, point: moved(volume.point) }
              : { ...volume, center: moved(volume.center) },
          ],
          softEdge: 0.3,
        }),
      ],
    }));
    const viewMatrix = translated4(CAMERA.viewMatrix, [-far[0], -far[1], -far[2]]);
    const camera = cameraFromMatrices(viewMatrix, CAMERA.projectionMatrix, CAMERA);
    const drawn = await expectAsReference(gpu.device, { clouds, camera, ...SIZE }, 1e-5);
    const near = SHAPES.map((volume) => ({
      set: SET,
      effects: [clip({ volumes: [volume], softEdge: 0.3 })],
    }));
    expect(drawn).toEqual(
      await expectAsReference(gpu.device, { clouds: near, camera: CAMERA, ...SIZE }, 1e-5),
    );
  });

  gpuTest('the comparison with float64 notices a ten-thousandth of a unit', async () => {
    const sphere = { shape: 'sphere', center: [0, 0.2, 0.3], radius: 0.7 } as const;
    const use = clip({ volumes: [sphere], softEdge: 0.3 });
    const shifted = { ...use, options: { volumes: [{ ...sphere, radius: 0.7001 }], softEdge: 0.3 } };
    const clouds = [{ set: SET, effects: [shifted] }];
    await expect(expectAsReference(gpu.device, { clouds, camera: CAMERA, ...SIZE }, 1e-5)).rejects.toThrow(
      /opacity is/,
    );
  });
});
