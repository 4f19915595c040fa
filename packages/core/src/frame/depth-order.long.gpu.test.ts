// Proves: splats closer than a step of float32 are in float64's order, from 12 cameras.
import { gpuTest, shareBlendingDevice } from '@websplatter/node/gpu-test';
import { beforeAll, describe, expect } from 'vitest';
import { SplatEngine } from '../create-engine.ts';
import type { AccuracySettings } from '../data/accuracy/accuracy.ts';
import { type Camera, orthographicCamera, perspectiveCamera } from '../data/camera/camera.ts';
import type { Vec3 } from '../data/math/mat4.ts';
import type { SplatSet } from '../data/splats/splat-set.ts';
import { type ReferenceFrame, renderReference } from '../reference/render.ts';
import { compareImages } from '../stages/measure/measure.reference.ts';
import { splatsOf } from '../testing/random-splats.ts';
import { seededRandom } from '../testing/seeded-random.ts';
import type { SplatView } from '../views/splat-view.ts';

/** Splats closer in depth than a step of float32, against float64. */

const SIZE = { widthPx: 48, heightPx: 48 };
const MIN_PSNR_DB = 90;

let engine: SplatEngine;
let view: SplatView;
beforeAll(async () => {
  engine = await SplatEngine.create({ device: await shareBlendingDevice(), accuracy: 'reference' });
  view = engine.createView();
});

type Vec = readonly [number, number, number];
const scaled = (a: Vec, factor: number): Vec => [a[0] * factor, a[1] * factor, a[2] * factor];
const sum = (...all: readonly Vec[]): Vec => all.reduce((a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]]);
const dot = (a: Vec, b: Vec) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const unit = (a: Vec): Vec => scaled(a, 1 / Math.sqrt(dot(a, a)));
const cross = (a: Vec, b: Vec): Vec => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];

/** A camera in any direction, and the unit vectors of its image. */
interface Look {
  readonly position: Vec;
  readonly forward: Vec;
  readonly right: Vec;
  readonly down: Vec;
}

function anyLook(random: () => number): Look {
  const forward = unit([random() - 0.5, 0.8 * (random() - 0.5), random() - 0.5]);
  const right = unit(cross(forward, [0, 1, 0]));
  const position = scaled([random() - 0.5, random() - 0.5, random() - 0.5], 4);
  return { position, forward, right, down: cross(forward, right) };
}

const cameraOf = ({ position, forward }: Look): Camera =>
  perspectiveCamera({
    ...{ position: position as Vec3, target: sum(position, forward) as Vec3, fovYDegrees: 50, aspect: 1 },
    ...{ near: 0.01, far: 100 },
  });

/**
 * Opaque splats of different colours in slabs across the view, each as thick as a step or two of
 * float32 at its depth. Coordinates are float32, so that each depth is where rounding has put it.
 */
function slabs(look: Look, random: () => number, count = 1200): SplatSet {
  const depths = [1.7, 3.1, 5.9];
  return splatsOf(
    Array.from({ length: count }, (_, i) => {
      const depth = depths[i % depths.length];
      const across = () => 0.9 * depth * (random() - 0.5);
      const thickness = depth * 2 ** -23 * (random() - 0.5);
      const position = sum(
        look.position,
        scaled(look.forward, depth + thickness),
        scaled(look.right, across()),
        scaled(look.down, across()),
      );
      const logScale = Math.log(0.06 * depth);
      return {
        position,
        logScales: [logScale, logScale, logScale],
        opacityLogit: 6,
        colorDc: [3.4 * random() - 1.7, 3.4 * random() - 1.7, 3.4 * random() - 1.7],
      };
    }),
  );
}

interface Scene extends Pick<ReferenceFrame, 'clouds' | 'camera' | 'sortBy'> {}

async function draw({ clouds, camera, sortBy }: Scene, accuracy: Partial<AccuracySettings>) {
  const added = clouds.map(({ set, ...placed }) => ({ cloud: engine.add(set as SplatSet), ...placed }));
  view.render({ camera, clouds: added, sortBy, ...SIZE, accuracy: { preset: 'reference', ...accuracy } });
  const { data } = await view.readPixels();
  for (const { cloud } of added) cloud.destroy();
  return data;
}

async function psnrDb(scene: Scene, accuracy: Partial<AccuracySettings>): Promise<number> {
  const expected = renderReference({ ...scene, ...SIZE });
  expect(expected.visibleSplats).toBeGreaterThan(100);
  return compareImages(await draw(scene, accuracy), expected.data, SIZE).psnrDb;
}

const RASTERIZERS = ['tiles', 'quads'] as const;

describe('depths closer than a step of float32', () => {
  for (const rasterizer of RASTERIZERS) {
    /**
     * @fault Order: opaque splats are closer in depth than a float32 step
     * @consequence `reference` draws them in float64 order, by tiles and by quads; other presets in
     *   float32 order
     */
    gpuTest(`${rasterizer}: 12 cameras see the order of float64, and by keys of 32 bits do not`, async () => {
      const random = seededRandom(5);
      let lost = 0;
      for (let i = 0; i < 12; i++) {
        const look = anyLook(random);
        const scene = { clouds: [{ set: slabs(look, random) }], camera: cameraOf(look) };
        expect(await psnrDb(scene, { rasterizer }), `camera ${i}`).toBeGreaterThan(MIN_PSNR_DB);
        if (i % 3 === 0 && (await psnrDb(scene, { rasterizer, sortKeyBits: 32 })) < 60) lost++;
      }
      expect(lost).toBe(4);
    });
  }

  gpuTest('several clouds, each by a matrix of its own, and far from the origin', async () => {
    const random = seededRandom(6);
    for (let i = 0; i < 4; i++) {
      const look = anyLook(random);
      const set = slabs(look, random, 900);
      const every = (part: number) => ({
        ...splatsOf(
          Array.from({ length: 300 }, (_, j) => {
            const at = 3 * j + part;
            return {
              position: [...set.positions.subarray(3 * at, 3 * at + 3)],
              logScales: [...set.logScales.subarray(3 * at, 3 * at + 3)],
              opacityLogit: 6,
              colorDc: [...set.colorDc.subarray(3 * at, 3 * at + 3)],
            };
          }),
        ),
      });
      // About another origin, and by matrices that undo it, turn it about and mirror it.
      const far = { ...every(1), origin: [6e6, -2e6, 3e6] as const };
      const back = Float64Array.of(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -6e6, 2e6, -3e6, 1);
      const mirrored = every(2);
      for (let j = 0; j < 900; j += 3) mirrored.positions[j] *= -1;
      const mirror = Float64Array.of(-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1);
      const clouds = [
        { set: every(0) },
        { set: far, modelMatrix: back },
        { set: mirrored, modelMatrix: mirror },
      ];
      for (const rasterizer of RASTERIZERS)
        expect(await psnrDb({ clouds, camera: cameraOf(look) }, { rasterizer })).toBeGreaterThan(MIN_PSNR_DB);
    }
  });

  gpuTest('without perspective, either side of the eye', async () => {
    const random = seededRandom(7);
    for (let i = 0; i < 4; i++) {
      const look = anyLook(random);
      const camera = orthographicCamera({
        ...{ position: look.position as Vec3, target: sum(look.position, look.forward) as Vec3 },
        ...{ aspect: 1, height: 6, near: -10, far: 10 },
      });
      const clouds = [{ set: slabs(look, random) }];
      for (const rasterizer of RASTERIZERS)
        expect(await psnrDb({ clouds, camera }, { rasterizer })).toBeGreaterThan(MIN_PSNR_DB);
    }
  });

  gpuTest('distances closer than that, on spheres about the eye', async () => {
    const random = seededRandom(8);
    for (let i = 0; i < 4; i++) {
      const look = anyLook(random);
      const set = slabs(look, random);
      for (let at = 0; at < 3 * set.count; at += 3) {
        const toward = [0, 1, 2].map((axis) => set.positions[at + axis] - look.position[axis]);
        const factor = (2.5 + 2 ** -21 * random()) / Math.hypot(...toward);
        for (let axis = 0; axis < 3; axis++)
          set.positions[at + axis] = look.position[axis] + factor * toward[axis];
      }
      const scene = { clouds: [{ set }], camera: cameraOf(look), sortBy: 'distance' } as const;
      for (const rasterizer of RASTERIZERS)
        expect(await psnrDb(scene, { rasterizer })).toBeGreaterThan(MIN_PSNR_DB);
    }
  });

  gpuTest('a lattice from its corner, where depths that are equal but for rounding decide', async () => {
    const random = seededRandom(9);
    const set = splatsOf(
      Array.from({ length: 1000 }, (_, i) => ({
        position: [i % 10, Math.floor(i / 10) % 10, Math.floor(i / 100)].map((step) => step / 8 - 0.5625),
        logScales: [-2.2, -2.2, -2.2],
        opacityLogit: 6,
        colorDc: [3.4 * random() - 1.7, 3.4 * random() - 1.7, 3.4 * random() - 1.7],
      })),
    );
    for (const position of [
      [3, 3, 3],
      [2, 2, -2],
      [-2.4, 1.2, 1.2],
    ] as const) {
      const camera = perspectiveCamera({ position, target: [0, 0, 0], fovYDegrees: 40, aspect: 1 });
      for (const rasterizer of RASTERIZERS)
        expect(await psnrDb({ clouds: [{ set }], camera }, { rasterizer })).toBeGreaterThan(MIN_PSNR_DB);
    }
  });

  gpuTest('instances are drawn as as many clouds are', async () => {
    const random = seededRandom(10);
    const look = anyLook(random);
    const set = slabs(look, random, 300);
    const matrices = Array.from({ length: 4 }, () => {
      const [x, y, z] = sum(scaled(look.right, random() - 0.5), scaled(look.down, random() - 0.5));
      return [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, y, z, 1];
    });
    const camera = cameraOf(look);
    const expected = renderReference({
      ...{ clouds: matrices.map((modelMatrix) => ({ set, modelMatrix })), camera, ...SIZE },
    });
    const cloud = engine.add(set);
    for (const rasterizer of RASTERIZERS) {
      const accuracy = { preset: 'reference', rasterizer } as const;
      const instances = { modelMatrices: matrices.flat() };
      view.render({ camera, clouds: [{ cloud, instances }], ...SIZE, accuracy });
      const { data } = await view.readPixels();
      expect(compareImages(data, expected.data, SIZE).psnrDb).toBeGreaterThan(MIN_PSNR_DB);
    }
    cloud.destroy();
  });
});
