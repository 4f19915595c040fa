import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { beforeAll, describe, expect } from 'vitest';
import { SplatEngine } from '../../create-engine.ts';
import { type Camera, orthographicCamera } from '../../data/camera/camera.ts';
import { DestroyedError, InvalidArgumentError } from '../../data/errors.ts';
import { COVER_CONSTANTS, CoverParameters, CoverPoint } from '../../data/layout/cover-structs.ts';
import { invert3, linearPart, transform3, type Vec3 } from '../../data/math/mat4.ts';
import { GpuMemory } from '../../gpu/gpu-memory.ts';
import type { Pipelines } from '../../gpu/pipelines.ts';
import { InspectedFrame, type InspectOptions } from '../../inspect/inspected-frame.ts';
import { readRecords } from '../../inspect/read-records.ts';
import { packFlatView } from '../../testing/flat-view.ts';
import { randomSplats, splatsOf } from '../../testing/random-splats.ts';
import { rankedBuffers, rankedRecords } from '../../testing/ranked-records.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { TEST_MODELS, testCameras } from '../../testing/test-cameras.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { anySplat, merged } from '../../testing/tile-buffers.ts';
import { visibleSplatOf } from '../../testing/visible-splat.ts';
import { coverStage, findCoverage, MAX_COVER_POINTS, type PointToCover } from '../../views/find-coverage.ts';
import { coverPoint } from './cover.reference.ts';
import { coverPoints } from './cover.ts';

const SIZE = { widthPx: 64, heightPx: 48 };
const CAMERAS = testCameras(SIZE.widthPx / SIZE.heightPx);

let device: GPUDevice;
let pipelines: Pipelines;
let memory: GpuMemory;
const counting = { readbacks: 0 };
const gpu = testGpu();

beforeAll(async () => {
  device = gpu.device;
  pipelines = gpu.pipelines;
  memory = new GpuMemory(device);
});

async function coverageIn(frame: InspectedFrame, points: readonly PointToCover[]) {
  const stage = coverStage(frame.parts, frame.plan);
  await pipelines.prepare([stage]);
  return findCoverage({ device, pipelines, memory, counting }, frame.parts, frame.plan, stage, points);
}

/** The point of the world that a camera sees in the middle of a pixel, at a view depth. */
function pointAt(
  { viewMatrix: v }: Camera,
  { projection: { isOrthographic, focalPx, centerPx } }: InspectedFrame,
  [column, row]: readonly [number, number],
  depthView: number,
): Vec3 {
  const scale = isOrthographic ? 1 : depthView;
  const x = ((column + 0.5 - centerPx[0]) / focalPx[0]) * scale;
  const y = ((centerPx[1] - row - 0.5) / focalPx[1]) * scale;
  return transform3(invert3(linearPart(v))!, [x - v[12], y - v[13], -depthView - v[14]]);
}

/** Compares the cover of random points with the reference's, for numbers that the stage reads. */
async function check(options: Omit<InspectOptions, 'widthPx' | 'heightPx'>, count = 60): Promise<number[]> {
  const frame = await InspectedFrame.draw(device, { keyBits: 32, ...options, ...SIZE });
  const splats = (await readRecords(frame)).map(visibleSplatOf);
  const depths = splats.map(({ depthView }) => depthView).sort((a, b) => a - b);
  const random = seededRandom(7);
  const places = Array.from({ length: count }, () => ({
    xPx: Math.floor(random() * SIZE.widthPx),
    yPx: Math.floor(random() * SIZE.heightPx),
    // Between two splats, so that rounding puts none on the other side.
    depthView: (() => {
      const at = Math.floor(random() * (depths.length - 1));
      return (depths[at] + depths[at + 1]) / 2;
    })(),
  }));
  const points = places.map(({ xPx, yPx, depthView }) => ({
    point: pointAt(options.camera, frame, [xPx, yPx], depthView),
  }));
  const found = await coverageIn(frame, points);
  for (const [i, { isInImage, isBehindHost, opacity }] of found.entries()) {
    expect({ isInImage, isBehindHost }, `point ${i}`).toEqual({ isInImage: true, isBehindHost: false });
    const expected = coverPoint(splats, places[i], frame.accuracy.alphaCutoff);
    // Half a step for each splat that may be there, and float32's rounding.
    const bound = (1 - expected) * ((0.5 * splats.length) / COVER_CONSTANTS.COVER_UNITS) + 1e-4;
    expect(Math.abs(opacity - expected), `point ${i}`).toBeLessThanOrEqual(Math.min(bound, 0.01));
  }
  frame.destroy();
  return found.map(({ opacity }) => opacity);
}

const splats = (count: number, seed: number) =>
  randomSplats({ count, seed, shDegree: 0, logScales: [-4, -1.5] });

describe('cover-points', () => {
  for (const [name, camera] of Object.entries(CAMERAS)) {
    gpuTest(`${name} camera: the opacity of the splats in front of each of many points`, async () => {
      const opacities = await check({ clouds: [{ set: splats(800, 1) }], camera });
      expect(Math.max(...opacities)).toBeGreaterThan(0.3);
      expect(Math.min(...opacities)).toBeLessThan(0.1);
    });
  }

  gpuTest('several clouds with models and opacities, f16 records, rows of 2', async () => {
    const camera = CAMERAS.perspective;
    const clouds = [
      { set: splats(700, 2), modelMatrix: TEST_MODELS.sheared, opacity: 0.5 },
      { set: splats(600, 3) },
    ];
    await check({ clouds, camera, accuracy: { recordPrecision: 'f16' }, dispatchRow: 2 });
  });

  gpuTest('records as in the paper', async () => {
    await check({
      clouds: [{ set: splats(800, 1) }],
      camera: CAMERAS.perspective,
      accuracy: { recordPrecision: 'paper' },
    });
  });

  gpuTest('merged splats among others', async () => {
    const random = seededRandom(11);
    const ranked = Array.from({ length: 60 }, (_, i) => ({
      ...merged(anySplat(random, SIZE), i),
      depthView: 1 + i,
    }));
    const packed = rankedRecords(ranked, 'f32');
    const visible = packed.records.map((record) => visibleSplatOf({ ...record, splat: 0 }));
    const places = Array.from({ length: 60 }, (_, i) => ({
      xPx: Math.floor(random() * SIZE.widthPx),
      yPx: Math.floor(random() * SIZE.heightPx),
      depthView: 0.5 + i,
    }));
    const points = new ArrayBuffer(CoverPoint.bytes * places.length);
    for (const [i, { xPx, yPx, depthView }] of places.entries())
      CoverPoint.write(
        points,
        { pixelPx: [xPx + 0.5, yPx + 0.5], depthView, storedDepth: 0 },
        CoverPoint.bytes * i,
      );
    const covers = gpu.storage([], 8 * places.length);
    const { order: _, ...buffers } = rankedBuffers(gpu, packed);
    const bindings = {
      ...buffers,
      view: gpu.uniform(packFlatView({ size: SIZE, alphaCutoff: 1 / 255, dispatchRow: 1 })),
      parameters: gpu.uniform(CoverParameters.pack({ pointCount: places.length })),
      points: gpu.storage(new Uint32Array(points)),
      covers,
    };
    await gpu.run(coverPoints('f32', null, true), bindings, [1, 1, 1]);
    const found = await gpu.read(covers);
    for (const [i, place] of places.entries()) {
      const expected = -Math.log(1 - coverPoint(visible, place, 1 / 255));
      // Half a step for each splat that may be there.
      expect(Math.abs(found[2 * i] / COVER_CONSTANTS.COVER_UNITS - expected), `point ${i}`).toBeLessThan(
        0.03,
      );
    }
  });

  gpuTest(
    'leaves out what is in front by less than the tolerance, and points outside of the image',
    async () => {
      const camera = orthographicCamera({
        position: [0, 0, 5],
        target: [0, 0, 0],
        aspect: 4 / 3,
        height: 1,
        far: 10,
      });
      const wall = splatsOf([{ position: [0, 0, 1], logScales: [2, 2, 2], opacityLogit: 9 }]);
      const frame = await InspectedFrame.draw(device, {
        clouds: [{ set: wall }],
        camera,
        keyBits: 32,
        ...SIZE,
      });
      const found = await coverageIn(frame, [
        { point: [0, 0, 0] },
        { point: [0, 0, 0.9], tolerance: 0.05 },
        { point: [0, 0, 0.9], tolerance: 0.2 },
        { point: [0, 0, 1.5] },
        { point: [0.7, 0, 0] },
        { point: [0, -0.6, 0] },
        { point: [0, 0, 6] },
        { point: [0, 0, -20] },
      ]);
      const covered = expect.closeTo(0.99, 3);
      expect(found.map(({ opacity }) => opacity)).toEqual([covered, covered, 0, 0, 0, 0, 0, 0]);
      expect(found.map(({ isInImage }) => isInImage)).toEqual([
        ...[true, true, true, true],
        ...[false, false, false, false],
      ]);
      frame.destroy();
      expect(memory.report().totalBytes).toBe(0);
    },
  );

  gpuTest('finds nothing in front without visible splats', async () => {
    const camera = CAMERAS.perspective;
    for (const clouds of [[], [{ set: splats(300, 1), opacity: 0 }]]) {
      const frame = await InspectedFrame.draw(device, { clouds, camera, keyBits: 32, ...SIZE });
      const point = pointAt(camera, frame, [32, 24], 2);
      expect(await coverageIn(frame, [{ point }])).toEqual([
        { isInImage: true, opacity: 0, isBehindHost: false },
      ]);
      expect(await coverageIn(frame, [])).toEqual([]);
      frame.destroy();
    }
  });
});

describe('coverage of a view', () => {
  gpuTest('names the fault of its points', async () => {
    const engine = await SplatEngine.create({ device: await shareTestDevice() });
    const view = engine.createEmbeddedView();
    const point: Vec3 = [0, 0, 0];
    expect(await view.coverage([{ point }])).toBeNull();
    for (const [points, message] of [
      [[{ point: [0, 0, Number.NaN] }], 'Point 0 is'],
      [[{ point }, { point: [0, 0] }], 'Point 1 is'],
      [[{ point, tolerance: -1 }], 'The tolerance of point 0 is -1'],
      [Array.from({ length: MAX_COVER_POINTS + 1 }, () => ({ point })), '1025 points are more than 1024'],
    ] as const) {
      const asking = view.coverage(points as readonly PointToCover[]);
      await expect(asking).rejects.toThrow(InvalidArgumentError);
      await expect(asking).rejects.toThrow(message);
    }
    view.destroy();
    await expect(view.coverage([{ point }])).rejects.toThrow(DestroyedError);
    engine.destroy();
  });
});
