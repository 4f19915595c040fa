import {
  GpuLimitError,
  InvalidArgumentError,
  perspectiveCamera,
  type SplatCloud,
  SplatEngine,
  type SplatSet,
} from '@websplatter/core';
import { compareImages, renderReference } from '@websplatter/core/reference';
import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { PerspectiveCamera, Raycaster, Sphere, Vector2, Vector3 } from 'three/webgpu';
import { beforeAll, describe, expect, vi } from 'vitest';
import { SplatCloudObject } from '../cloud/splat-cloud-object.ts';
import { editsOf } from './edits-of.ts';
import { type MorphData, makeMorphData } from './make-morph-data.ts';
import { makeSplatData } from './make-splat-data.ts';

const SIZE = { widthPx: 64, heightPx: 64 };
const CAMERA = perspectiveCamera({ position: [0, 0, 4], target: [0, 0, 0], fovYDegrees: 50, aspect: 1 });
const COLORS = [1, 0, 0, 0, 1, 0];
const SCALES = [0.2, 0.2, 0.2, 0.3, 0.2, 0.1];
const FROM = { positions: [-0.8, 0, 0, 0.8, 0, 0], scales: SCALES, colors: COLORS };
/** As float64 halfway has it, too: only positions differ. */
const TO = { ...FROM, positions: [-0.8, 0.8, 0, 0.8, -0.8, 0] };
const HALFWAY = { ...FROM, positions: [-0.8, 0.4, 0, 0.8, -0.4, 0] };

let engine: SplatEngine;
beforeAll(async () => {
  engine = await SplatEngine.create({ device: await shareTestDevice() });
});

/** Data that an object shows on the engine, once the cloud follows. */
async function shown(data: MorphData) {
  const object = new SplatCloudObject(data);
  const cloud = data.acquire(engine, object) as SplatCloud;
  const needsframe = vi.fn();
  object.addEventListener('needsframe', needsframe);
  await expect.poll(() => cloud.isHeld).toBe(false);
  return { object, cloud, needsframe };
}

async function psnrDb(cloud: SplatCloud, expected: SplatSet): Promise<number> {
  const view = engine.createView();
  view.render({ camera: CAMERA, clouds: [{ cloud }], ...SIZE });
  const { data } = await view.readPixels();
  view.destroy();
  const reference = renderReference({ clouds: [{ set: expected }], camera: CAMERA, ...SIZE });
  return compareImages(data, reference.data, SIZE).psnrDb;
}

const setOf = (arrays: typeof FROM) => makeSplatData(arrays).set!;

describe('data of a morph', () => {
  gpuTest('are drawn between their clouds, and ask for one frame for all changes of a task', async () => {
    const data = makeMorphData(FROM, TO, { name: 'faces', accuracy: 'reference' });
    expect([data.name, data.count, data.bounds.min.y, data.bounds.max.y]).toEqual([
      'faces',
      2,
      -Math.fround(0.8),
      Math.fround(0.8),
    ]);
    data.amount = 1;
    const { cloud, needsframe } = await shown(data);
    await expect.poll(() => needsframe.mock.calls.length).toBeGreaterThan(0);
    expect(await psnrDb(cloud, setOf(TO))).toBeGreaterThan(60);
    needsframe.mockClear();
    data.amount = 0.25;
    data.amount = 0.5;
    await Promise.resolve();
    expect(needsframe).toHaveBeenCalledOnce();
    data.amount = 0.5;
    await Promise.resolve();
    expect(needsframe).toHaveBeenCalledOnce();
    expect(await psnrDb(cloud, setOf(HALFWAY))).toBeGreaterThan(60);
    data.amount = 0;
    expect(await psnrDb(cloud, setOf(FROM))).toBeGreaterThan(60);
    expect(await psnrDb(cloud, setOf(HALFWAY))).toBeLessThan(30);
  });

  gpuTest('are met by rays and sought where they are', async () => {
    const data = makeMorphData(FROM, TO);
    data.amount = 0.5;
    const sphere = new Sphere(new Vector3(-0.8, 0.4, 0), 0.1);
    // Nothing is on a GPU yet.
    expect([...(await data.rowsIn(sphere))]).toEqual([0]);
    const { object, cloud } = await shown(data);
    await data.prepareRays();
    expect([...(await data.rowsIn(sphere))]).toEqual([0]);
    const camera = new PerspectiveCamera(50);
    camera.position.z = 4;
    camera.updateMatrixWorld();
    const raycaster = new Raycaster();
    raycaster.setFromCamera(new Vector2().copy(new Vector3(-0.8, 0.4, 0).project(camera)), camera);
    expect(raycaster.intersectObject(object)).toHaveLength(1);
    data.amount = 1;
    await Promise.resolve();
    await expect.poll(() => raycaster.intersectObject(object)).toHaveLength(0);
    expect(cloud.isDestroyed).toBe(false);
  });

  gpuTest('tell objects where memory is lacking', async () => {
    const data = makeMorphData(FROM, TO);
    const object = new SplatCloudObject(data);
    const told: Error[] = [];
    object.onError = (error) => told.push(error);
    const device = await shareTestDevice();
    const small = await SplatEngine.create({ device, memoryBudgetBytes: 128 });
    data.acquire(small, object);
    await expect.poll(() => told).toHaveLength(1);
    expect(told[0]).toBeInstanceOf(GpuLimitError);
    small.destroy();
  });

  gpuTest('refuse clouds of different sizes, amounts that are no numbers, and edits', () => {
    const one = { positions: [0, 0, 0], scales: [1, 1, 1], colors: [1, 1, 1] };
    expect(() => makeMorphData(FROM, one)).toThrow(/2 splats and to has 1/);
    expect(() => makeMorphData(FROM, { ...TO, scales: [1] })).toThrow(InvalidArgumentError);
    const data = makeMorphData(FROM, TO, { name: 'faces' });
    expect(() => {
      data.amount = Number.NaN;
    }).toThrow(InvalidArgumentError);
    data.amount = 3;
    expect(data.amount).toBe(1);
    expect(() => editsOf(data)).toThrow(/faces is a morph/);
  });
});
