import { gpuTest } from '@websplatter/node/gpu-test';
import { beforeAll, describe, expect } from 'vitest';
import { type Camera, orthographicCamera } from '../../data/camera/camera.ts';
import { InvalidArgumentError } from '../../data/errors.ts';
import { PickBlock, PickParameters } from '../../data/layout/pick-structs.ts';
import { transform3 } from '../../data/math/mat4.ts';
import { GpuMemory } from '../../gpu/gpu-memory.ts';
import type { Pipelines } from '../../gpu/pipelines.ts';
import { InspectedFrame, type InspectOptions } from '../../inspect/inspected-frame.ts';
import { readRecords } from '../../inspect/read-records.ts';
import { packFlatView } from '../../testing/flat-view.ts';
import { randomSplats, type SplatValues, splatsOf } from '../../testing/random-splats.ts';
import { rankedBuffers, rankedRecords } from '../../testing/ranked-records.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { TEST_MODELS, testCameras } from '../../testing/test-cameras.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { anySplat, merged } from '../../testing/tile-buffers.ts';
import { visibleSplatOf } from '../../testing/visible-splat.ts';
import { pickSplat, type SplatPick } from '../../views/pick-splat.ts';
import { cullSplat, type VisibleSplat } from '../cull/cull.reference.ts';
import { pickSplat as pickReference } from './pick.reference.ts';
import { pick as pickStage } from './pick.ts';

const SIZE = { widthPx: 64, heightPx: 64 };
const CAMERAS = testCameras(1);

let device: GPUDevice;
let pipelines: Pipelines;
let memory: GpuMemory;
const counting = { readbacks: 0 };
const gpu = testGpu();

beforeAll(async () => {
  device = gpu.device;
  pipelines = gpu.pipelines;
  memory = new GpuMemory(device);
  await pipelines.prepare([pickStage('f32'), pickStage('f16'), pickStage('paper')]);
});

type Scene = Omit<InspectOptions, 'widthPx' | 'heightPx'>;

function draw(scene: Scene): Promise<InspectedFrame> {
  return InspectedFrame.draw(device, { keyBits: 32, ...scene, ...SIZE });
}

function pickAt(frame: InspectedFrame, xPx: number, yPx: number): Promise<SplatPick | null> {
  const context = { device, pipelines, memory, counting, destroyedBecause: () => null };
  return pickSplat(context, frame.parts, frame.plan, xPx, yPx);
}

/** The frame's splats in the GPU's order, with exactly the numbers that the stage reads. */
async function drawnByGpu(frame: InspectedFrame): Promise<{ splats: VisibleSplat[]; numbers: number[] }> {
  const records = await readRecords(frame);
  const ordered = Array.from(await frame.sorted('order'), (index) => records[index]);
  return { splats: ordered.map(visibleSplatOf), numbers: ordered.map(({ splat }) => splat) };
}

/** The frame's splats computed from the scene in float64, in exact order. */
function drawnByReference({ clouds, projection, accuracy: { alphaCutoff } }: InspectedFrame) {
  const drawn = clouds.flatMap(({ stored, view, effects, dilationPx2 }) =>
    Array.from({ length: stored.count }, (_, index) =>
      cullSplat(stored, index, view, projection, { alphaCutoff, dilationPx2, effects }),
    ).filter((splat) => splat !== null),
  );
  return drawn.sort((a, b) => b.depthView - a.depthView);
}

/**
 * Weights are products of float32 within a block of 256, whose roundings add up to 256·2^-23 =
 * 3e-5, and opacities come from an `exp` of some ulp.
 */
const WEIGHT_ERROR = 5e-5;

interface CheckOptions {
  readonly pixels?: number;
  /** Permitted error of the image's alpha: in rgba16float many faint layers stall. */
  readonly imageError?: number;
  /** Permitted difference from a pick in float64, which depends on the precision of records. */
  readonly exactError?: number;
}

/** Compares picks all over the image with the reference's; returns those that found a splat. */
async function check(
  scene: Scene,
  { pixels = 30, imageError = 4e-3, exactError = 2e-3 }: CheckOptions = {},
): Promise<SplatPick[]> {
  const frame = await draw(scene);
  const { alphaCutoff } = frame.accuracy;
  const drawn = await drawnByGpu(frame);
  const reference = drawnByReference(frame);
  const random = seededRandom(5);
  const picks: SplatPick[] = [];
  let others = 0;
  for (let i = 0; i < pixels; i++) {
    const [xPx, yPx] = [SIZE.widthPx * random(), SIZE.heightPx * random()];
    const [column, row] = [Math.floor(xPx), Math.floor(yPx)];
    const got = await pickAt(frame, xPx, yPx);
    const expected = pickReference(drawn.splats, column, row, alphaCutoff);
    const alphaInImage = frame.image.data[4 * (row * SIZE.widthPx + column) + 3];
    const place = `pixel ${column}, ${row}`;
    expect(got === null, place).toBe(expected === null);
    expect(Math.abs((got?.totalOpacity ?? 0) - alphaInImage), place).toBeLessThanOrEqual(imageError);
    if (!got || !expected) continue;
    picks.push(got);
    expect(Math.abs(got.weight - expected.weight), place).toBeLessThanOrEqual(WEIGHT_ERROR);
    expect(Math.abs(got.totalOpacity - expected.totalOpacity), place).toBeLessThanOrEqual(WEIGHT_ERROR);
    const { cloud, index } = frame.locate(drawn.numbers[expected.index]);
    const isSame = frame.clouds[got.cloudIndex] === cloud && got.storedIndex === index;
    if (isSame) {
      expect(Math.abs(got.alpha - expected.alpha), place).toBeLessThanOrEqual(1e-5);
      expect(got.depthView, place).toBe(drawn.splats[expected.index].depthView);
      expect(got.rank, place).toBe(expected.rank);
      expect(got.row, place).toBe(cloud.stored.fileIndices[index]);
      expect(got.cloud, place).toBe(frame.plan.shape.clouds[got.cloudIndex].cloud);
    } else others++;

    // The float64 scene: splats whose depths float32 cannot distinguish may swap places.
    const exact = pickReference(reference, column, row, alphaCutoff);
    expect(Math.abs(got.weight - exact!.weight), place).toBeLessThanOrEqual(exactError);
    expect(Math.abs(got.totalOpacity - exact!.totalOpacity), place).toBeLessThanOrEqual(exactError);

    expectOnRay(got, scene.camera, column, row, frame);
  }
  // Either splat may be picked if two weights differ only by rounding.
  expect(others).toBeLessThanOrEqual(pixels / 20);
  frame.destroy();
  return picks;
}

/** Checks that the world point projects to the middle of the pixel at the splat's depth. */
function expectOnRay(
  { point, depthView }: SplatPick,
  { viewMatrix, projectionMatrix: p }: Camera,
  column: number,
  row: number,
  { projection }: InspectedFrame,
): void {
  const v = Array.from(viewMatrix);
  const linear = [v[0], v[1], v[2], v[4], v[5], v[6], v[8], v[9], v[10]];
  const [x, y, z] = transform3(linear, point).map((value, axis) => value + v[12 + axis]);
  expect(-z).toBeCloseTo(depthView, 9);
  const w = p[11] * z + p[15];
  expect((((p[0] * x + p[8] * z + p[12]) / w + 1) / 2) * projection.widthPx).toBeCloseTo(column + 0.5, 6);
  expect(((1 - (p[5] * y + p[9] * z + p[13]) / w) / 2) * projection.heightPx).toBeCloseTo(row + 0.5, 6);
}

const splats = (count: number, seed: number) =>
  randomSplats({ count, seed, shDegree: 0, logScales: [-4, -1.5] });

describe('pick', () => {
  for (const [name, camera] of Object.entries(CAMERAS)) {
    gpuTest(`${name} camera: the heaviest splat of any pixel`, async () => {
      const picks = await check({ clouds: [{ set: splats(800, 1) }], camera });
      expect(picks.length).toBeGreaterThan(5);
    });
  }

  gpuTest('several clouds with models and opacities, pages, packed, f16 records, rows of 2', async () => {
    const picks = await check(
      {
        clouds: [
          { set: splats(700, 2), modelMatrix: TEST_MODELS.sheared, splatsPerPage: 256 },
          { set: splats(0, 1) },
          { set: splats(600, 3), opacity: 0.6, splatsPerPage: 512 },
          { set: splats(300, 4), modelMatrix: TEST_MODELS.mirrored },
        ],
        camera: CAMERAS.perspective,
        accuracy: { geometryPrecision: 'packed', recordPrecision: 'f16' },
        dispatchRow: 2,
      },
      { pixels: 60 },
    );
    expect(new Set(picks.map(({ cloudIndex }) => cloudIndex))).toEqual(new Set([0, 2, 3]));
  });

  gpuTest('records as in the paper', async () => {
    const picks = await check(
      {
        clouds: [{ set: splats(800, 1) }],
        camera: CAMERAS.perspective,
        accuracy: { recordPrecision: 'paper' },
      },
      // Opacities err by half a step of 255 each.
      { exactError: 8e-3 },
    );
    expect(picks.length).toBeGreaterThan(5);
  });

  gpuTest('thousands of layers over every pixel, in more than one block of the order', async () => {
    const layers = (count: number, opacityLogit: number, from: number): SplatValues[] =>
      Array.from({ length: count }, (_, i) => ({
        position: [0, 0, from - ((i * 7919) % count) / count],
        logScales: [1, 1, 1],
        opacityLogit,
      }));
    const camera = orthographicCamera({ position: [0, 0, 5], target: [0, 0, 0], aspect: 1, height: 1 });
    // A faint veil around one solid splat: the pixel shows the solid one.
    const veil = [
      ...layers(300, -4.5, 2),
      { position: [0, 0, 0], logScales: [1, 1, 1] },
      ...layers(2500, -4.5, -1),
    ];
    const [pick] = await check(
      { clouds: [{ set: splatsOf(veil) }], camera },
      { pixels: 3, imageError: 0.03 },
    );
    expect(pick).toMatchObject({ row: 300, depthView: 5, alpha: expect.closeTo(0.99, 6), rank: 300 });
    expect(pick.weight).toBeLessThan(0.05);
    // A veil without a solid splat: all opacities are equal, so the foremost wins.
    const [foremost] = await check(
      { clouds: [{ set: splatsOf(layers(2500, -4.5, 2)) }], camera },
      { pixels: 3, imageError: 0.03 },
    );
    expect(foremost.depthView).toBe(3);
  });

  gpuTest('at equal depths the splat drawn last is foremost', async () => {
    const camera = orthographicCamera({ position: [0, 0, 5], target: [0, 0, 0], aspect: 1, height: 1 });
    const same = splatsOf(Array.from({ length: 40 }, () => ({ opacityLogit: 0 })));
    const frame = await draw({ clouds: [{ set: same }, { set: same }], camera });
    const pick = await pickAt(frame, 32, 32);
    expect(pick).toMatchObject({ cloudIndex: 1, row: 39, totalOpacity: 1, rank: 0 });
    expect(pick?.point[2]).toBe(0);
    frame.destroy();
  });

  gpuTest('the opacity is capped as in the image', async () => {
    const camera = orthographicCamera({ position: [0, 0, 5], target: [0, 0, 0], aspect: 1, height: 1 });
    const frame = await draw({ clouds: [{ set: splatsOf([{ logScales: [2, 2, 2] }]) }], camera });
    expect((await pickAt(frame, 10, 50))?.alpha).toBe(Math.fround(0.99));
    frame.destroy();
  });

  gpuTest('the heaviest of merged splats among others', async () => {
    const random = seededRandom(9);
    const ranked = Array.from({ length: 60 }, (_, i) => merged(anySplat(random, SIZE), i));
    const packed = rankedRecords(ranked, 'f32');
    const backToFront = packed.records.map((record) => visibleSplatOf({ ...record, splat: 0 })).reverse();
    const view = packFlatView({ size: SIZE, alphaCutoff: 1 / 255, dispatchRow: 1 });
    const blocks = gpu.storage([], PickBlock.bytes);
    const bindings = { ...rankedBuffers(gpu, packed), view: gpu.uniform(view), blocks };
    let found = 0;
    for (let i = 0; i < 40; i++) {
      const [column, row] = [Math.floor(64 * random()), Math.floor(64 * random())];
      const contents = PickParameters.pack({ pixelPx: [column + 0.5, row + 0.5], blockCount: 1 });
      const parameters = gpu.uniform(contents);
      const visibleSplats = gpu.storage(packed.places);
      await gpu.run(pickStage('f32', true), { ...bindings, parameters, visibleSplats }, [1, 1, 1]);
      const [transmittance, weight, , alpha] = new Float32Array((await gpu.read(blocks)).buffer);
      const expected = pickReference(backToFront, column, row, 1 / 255);
      const place = `pixel ${column}, ${row}`;
      expect(Math.abs(1 - transmittance - (expected?.totalOpacity ?? 0)), place).toBeLessThan(WEIGHT_ERROR);
      expect(Math.abs(weight - (expected?.weight ?? 0)), place).toBeLessThan(WEIGHT_ERROR);
      expect(Math.abs(alpha - (expected?.alpha ?? 0)), place).toBeLessThan(WEIGHT_ERROR);
      if (expected) found++;
    }
    expect(found).toBeGreaterThan(20);
  });

  gpuTest('picks nothing without visible splats: no clouds, none in sight, too faint', async () => {
    const camera = CAMERAS.perspective;
    const away = Float64Array.of(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 500, 1);
    for (const clouds of [
      [],
      [{ set: splats(0, 1) }],
      [{ set: splats(300, 1), modelMatrix: away }],
      [{ set: splats(300, 1), opacity: 0 }],
    ]) {
      const frame = await draw({ clouds, camera });
      expect(await pickAt(frame, 32, 32)).toBeNull();
      frame.destroy();
    }
  });

  gpuTest('gives the same pick every time, outlives its frame and leaves no memory behind', async () => {
    const camera = CAMERAS.perspective;
    const frame = await draw({ clouds: [{ set: splats(2000, 6) }], camera });
    const [first, ...rest] = await Promise.all(Array.from({ length: 10 }, () => pickAt(frame, 30.2, 33.9)));
    expect(first).not.toBeNull();
    for (const pick of rest) expect(pick).toEqual(first);
    const pending = pickAt(frame, 30.2, 33.9);
    expect(memory.report().totalBytes).toBeGreaterThan(0);
    frame.destroy();
    expect(await pending).toEqual(first);
    expect(memory.report().totalBytes).toBe(0);
  });

  gpuTest('refuses pixels outside of the image', async () => {
    const camera = CAMERAS.perspective;
    const frame = await draw({ clouds: [{ set: splats(10, 1) }], camera });
    for (const [xPx, yPx] of [
      [-0.1, 5],
      [64, 5],
      [5, -1],
      [5, 64],
      [Number.NaN, 5],
    ]) {
      await expect(pickAt(frame, xPx, yPx)).rejects.toThrow(InvalidArgumentError);
    }
    await pickAt(frame, 0, 63.99);
    expect(memory.report().totalBytes).toBe(0);
    frame.destroy();
  });
});
