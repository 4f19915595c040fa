import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { cameraFromMatrices } from '../../../data/camera/camera.ts';
import { translated4, type Vec3 } from '../../../data/math/mat4.ts';
import { expectAsReference } from '../../../testing/expect-as-reference.ts';
import { randomSplats } from '../../../testing/random-splats.ts';
import { seededRandom } from '../../../testing/seeded-random.ts';
import { TEST_MODELS, testCameras } from '../../../testing/test-cameras.ts';
import { testGpu } from '../../../testing/test-gpu.ts';
import type { Volume, VolumeChange, VolumeShape } from './volumes.ts';
import { volumes } from './volumes.ts';

const isFull = process.env.WEBSPLATTER_FULL === '1';

const SIZE = { widthPx: 48, heightPx: 48 };
const CAMERA = testCameras(1).perspective;
const SET = randomSplats({ count: 100, seed: 61, shDegree: 0, opacityLogits: [0, 4], colorDc: [-3, 3] });
const FLAT = Float64Array.of(1, 0.2, 0, 0, 0.1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0.1, 1);
/** The first leaves clouds where they are. */
const MODELS = isFull
  ? [...Object.values(TEST_MODELS), FLAT]
  : [TEST_MODELS.identity, TEST_MODELS.sheared, FLAT];
/** Turned, stretched along each axis and sheared. */
const MATRIX = [0.8, 0.3, 0, 0, -0.3, 1.1, 0.2, 0, 0.1, -0.2, 0.6, 0, 0.1, -0.05, 0.1, 1];

const ROTATION = [0.3, -0.2, 0.4, 0.9] as const;
const SHAPES: readonly VolumeShape[] = [
  { shape: 'box', center: [0.2, 0.1, 0], size: [1, 0.8, 1.4], rotation: ROTATION },
  { shape: 'sphere', center: [0, 0.2, 0.3], radius: 0.7 },
  { shape: 'ellipsoid', center: [0.1, 0, 0.2], size: [1, 1.8, 1.2], rotation: ROTATION },
  { shape: 'capsule', center: [0, 0.1, 0.1], radius: 0.5, height: 0.6, rotation: ROTATION },
  { shape: 'plane', point: [0.1, 0, 0.1], normal: [0.2, -3, 1] },
];
const CHANGES: readonly VolumeChange[] = [
  { mode: 'keep' },
  { mode: 'hide' },
  { mode: 'fade', opacity: 0.3 },
  { mode: 'tint', tint: [0.2, 1.4, 0.7] },
  { mode: 'displace', offset: [0.1, 0.3, -0.2] },
];

const gpu = testGpu();

describe('volumes', () => {
  for (const shape of SHAPES) {
    const name = `${shape.shape}: every mode and side, soft and hard, for clouds in any place`;
    gpuTest(name, { tags: 'deeper' }, async () => {
      const clouds = MODELS.flatMap((modelMatrix, i) =>
        CHANGES.flatMap((change, j) =>
          [false, true].map((invert, k) => ({
            set: SET,
            modelMatrix,
            effects: [
              volumes([
                {
                  ...shape,
                  ...change,
                  invert,
                  softEdge: (i + j + k) % 2 === 0 ? 0.3 : 0,
                  ...((i + k) % 2 === 0 && { matrix: MATRIX }),
                },
              ]),
            ],
          })),
        ),
      );
      const drawn = await expectAsReference(gpu.device, { clouds, camera: CAMERA, ...SIZE }, 1e-5);
      const [all] = await expectAsReference(
        gpu.device,
        { clouds: [{ set: SET }], camera: CAMERA, ...SIZE },
        1e-5,
      );
      for (const count of drawn.slice(0, 4)) {
        expect(count).toBeGreaterThan(3);
        expect(count).toBeLessThan(all - 3);
      }
    });
  }

  gpuTest('each of eight volumes cuts, and volumes that contain nothing leave nothing', async () => {
    // Each removes one corner of the cloud.
    const corners = [-1, 1].flatMap((x) => [-1, 1].flatMap((y) => [-1, 1].map((z): Vec3 => [x, y, z])));
    const planes = corners.map((normal): Volume => {
      const point = normal.map((coordinate) => coordinate * -0.3) as unknown as Vec3;
      return { shape: 'plane', mode: 'keep', point, normal };
    });
    const flat = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1];
    const empty: readonly VolumeShape[] = [
      { shape: 'sphere', radius: 0 },
      { shape: 'box', size: [2, 2, 0] },
      ...SHAPES.map((shape) => ({ ...shape, matrix: flat })),
    ];
    const clouds = [
      ...planes.map((_, last) => ({ set: SET, effects: [volumes(planes.slice(0, last + 1))] })),
      ...empty.map((shape) => ({ set: SET, effects: [volumes([{ ...shape, mode: 'keep' }])] })),
      ...empty.map((shape) => ({ set: SET, effects: [volumes([{ ...shape, mode: 'hide' }])] })),
      { set: SET },
    ];
    const drawn = await expectAsReference(gpu.device, { clouds, camera: CAMERA, ...SIZE }, 1e-5);
    const all = drawn.at(-1)!;
    for (let i = 1; i < 8; i++) expect(drawn[i]).toBeLessThan(drawn[i - 1]);
    expect(drawn[7]).toBeGreaterThan(0);
    expect(drawn.slice(8)).toEqual([...empty.map(() => 0), ...empty.map(() => all), all]);
  });

  gpuTest('up to 256 volumes of all shapes and modes act in their order', { tags: 'deeper' }, async () => {
    const random = seededRandom(64);
    const within = (most: number): Vec3 => {
      const [x, y, z] = [random(), random(), random()].map((value) => most * (2 * value - 1));
      return [x, y, z];
    };
    const list = Array.from({ length: 256 }, (_, i): Volume => {
      const [x, y, z] = within(1);
      const size = 0.1 + 0.4 * random();
      const matrix = [size, 0, 0, 0, 0, 0.5 * size, 0, 0, 0, 0, size, 0, x, y, z, 1];
      const change = CHANGES.slice(1)[i % 4];
      const shape = SHAPES[i % 4];
      return { ...shape, ...change, matrix, softEdge: i % 3 === 0 ? 0 : 0.2 };
    });
    const clouds = (isFull ? [256, 97, 96, 64, 25, 24, 5] : [256, 97, 25]).map((count) => ({
      set: SET,
      effects: [volumes(list.slice(0, count))],
    }));
    const backwards = { set: SET, effects: [volumes(list.slice(0, 64).toReversed())] };
    const options = { clouds: [...clouds, backwards], camera: CAMERA, ...SIZE };
    for (const count of await expectAsReference(gpu.device, options, 1e-4)) expect(count).toBeGreaterThan(0);
  });

  gpuTest('splats are displaced into view from outside of it', async () => {
    const away: Vec3 = [40, 0, 0];
    const half = [0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 1];
    const box = { shape: 'box', center: [20, 0, 0], size: [9, 9, 9] } as const;
    const displaced = { ...box, mode: 'displace', offset: [-20, 0, 0] } as const;
    const set = { ...SET, origin: away };
    const clouds = [[displaced], []].map((list) => ({ set, modelMatrix: half, effects: [volumes(list)] }));
    const here = { set: SET, modelMatrix: half };
    const drawn = await expectAsReference(
      gpu.device,
      { clouds: [...clouds, here], camera: CAMERA, ...SIZE },
      1e-4,
    );
    expect(drawn[0]).toBeGreaterThan(3);
    expect(drawn).toEqual([drawn[2], 0, drawn[2]]);
  });

  gpuTest('edges stay in place 6,400 km from the origin of the world', async () => {
    const far: Vec3 = [6.4e6, -6.4e6, 6.4e6];
    const matrix = translated4([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1], far);
    const volumeOf = (shape: VolumeShape): Volume => ({ ...shape, mode: 'keep', softEdge: 0.3 });
    const clouds = SHAPES.map((shape) => ({
      set: { ...SET, origin: far },
      effects: [volumes([{ ...volumeOf(shape), matrix }])],
    }));
    const viewMatrix = translated4(CAMERA.viewMatrix, [-far[0], -far[1], -far[2]]);
    const camera = cameraFromMatrices(viewMatrix, CAMERA.projectionMatrix, CAMERA);
    const drawn = await expectAsReference(gpu.device, { clouds, camera, ...SIZE }, 1e-5);
    const near = SHAPES.map((shape) => ({ set: SET, effects: [volumes([volumeOf(shape)])] }));
    expect(drawn).toEqual(
      await expectAsReference(gpu.device, { clouds: near, camera: CAMERA, ...SIZE }, 1e-5),
    );
  });

  gpuTest('the comparison with float64 notices a ten-thousandth of a unit', async () => {
    const sphere = {
      shape: 'sphere',
      mode: 'keep',
      center: [0, 0.2, 0.3],
      radius: 0.7,
      softEdge: 0.3,
    } as const;
    const use = volumes([sphere]);
    const shifted = { ...use, options: [{ ...sphere, radius: 0.7001 }] };
    const clouds = [{ set: SET, effects: [shifted] }];
    await expect(expectAsReference(gpu.device, { clouds, camera: CAMERA, ...SIZE }, 1e-5)).rejects.toThrow(
      /opacity is/,
    );
  });
});
