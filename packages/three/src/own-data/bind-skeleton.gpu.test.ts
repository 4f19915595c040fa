import {
  InvalidArgumentError,
  perspectiveCamera,
  type SplatCloud,
  SplatEngine,
  type SplatSet,
} from '@websplatter/core';
import { compareImages, renderReference } from '@websplatter/core/reference';
import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { Bone, Group, Skeleton, Sphere, Vector3 } from 'three/webgpu';
import { beforeAll, describe, expect, vi } from 'vitest';
import { SplatCloudObject } from '../cloud/splat-cloud-object.ts';
import { bindSkeleton } from './bind-skeleton.ts';
import { editsOf } from './edits-of.ts';
import { makeMorphData } from './make-morph-data.ts';
import { makeSplatData } from './make-splat-data.ts';

const SIZE = { widthPx: 64, heightPx: 64 };
const CAMERA = perspectiveCamera({ position: [0, 0, 4], target: [0, 0, 0], fovYDegrees: 50, aspect: 1 });
/** The first splat follows the first bone, the second one the other. */
const WEIGHTS = { indices: [0, 0, 0, 0, 1, 0, 0, 0], weights: [1, 0, 0, 0, 1, 0, 0, 0] };
const ARRAYS = {
  positions: [-0.8, 0, 0, 0.8, 0, 0],
  scales: [0.2, 0.2, 0.2, 0.3, 0.1, 0.1],
  colors: [1, 0, 0, 0, 1, 0],
};
/** The second splat a quarter turn further about the middle, which lies in the second bone. */
const TURNED = {
  ...ARRAYS,
  positions: [-0.8, 0, 0, 0, 0.8, 0],
  scales: [0.2, 0.2, 0.2, 0.1, 0.3, 0.1],
};

let engine: SplatEngine;
beforeAll(async () => {
  engine = await SplatEngine.create({ device: await shareTestDevice(), accuracy: 'high' });
});

/** A cloud in a moved group, and two bones beside it; their skeleton is made there, in world space. */
async function scene() {
  const data = makeSplatData(ARRAYS, { name: 'arm', accuracy: 'high' });
  const object = new SplatCloudObject(data);
  const group = new Group();
  group.position.set(0.3, -2, 1);
  group.rotation.y = 0.7;
  const bones = [new Bone(), new Bone()];
  bones[0].add(bones[1]);
  group.add(object, bones[0]);
  group.updateMatrixWorld(true);
  const skeleton = new Skeleton(bones);
  const cloud = data.acquire(engine, object) as SplatCloud;
  return { data, object, group, bones, skeleton, cloud };
}

async function psnrDb(cloud: SplatCloud, expected: SplatSet): Promise<number> {
  const view = engine.createView();
  view.render({ camera: CAMERA, clouds: [{ cloud }], ...SIZE });
  const { data } = await view.readPixels();
  view.destroy();
  const reference = renderReference({ clouds: [{ set: expected }], camera: CAMERA, ...SIZE });
  return compareImages(data, reference.data, SIZE).psnrDb;
}

const setOf = (arrays: typeof ARRAYS) => makeSplatData(arrays).set!;

/** Waits until frames of the cloud show the pose, which takes a while after it has its skin. */
async function isFollowing(cloud: SplatCloud): Promise<void> {
  await expect.poll(() => cloud.features[0]?.name).toBe('a skin');
  await (cloud.features[0] as unknown as { readonly ready: Promise<void> }).ready;
}

describe('bones of a cloud', () => {
  gpuTest('move its splats before each frame, and request no frames', async () => {
    const { data, object, group, bones, skeleton, cloud } = await scene();
    bindSkeleton(object, skeleton, WEIGHTS, object.matrixWorld);
    await isFollowing(cloud);
    const needsframe = vi.fn();
    await expect.poll(async () => psnrDb(cloud, setOf(ARRAYS))).toBeGreaterThan(55);
    object.addEventListener('needsframe', needsframe);
    const { version } = cloud;
    bones[1].rotation.z = Math.PI / 2;
    group.updateMatrixWorld(true);
    expect(await psnrDb(cloud, setOf(TURNED))).toBeGreaterThan(55);
    expect(await psnrDb(cloud, setOf(ARRAYS))).toBeLessThan(30);
    expect(cloud.version).toBe(version + 1);
    expect(data.bounds.max.y).toBeCloseTo(0.8, 5);
    // The object and its bones move together: nothing is written.
    group.position.x = 7;
    group.updateMatrixWorld(true);
    expect(await psnrDb(cloud, setOf(TURNED))).toBeGreaterThan(55);
    expect(cloud.version).toBe(version + 1);
    bones[1].rotation.z = 0;
    group.updateMatrixWorld(true);
    expect(await psnrDb(cloud, setOf(ARRAYS))).toBeGreaterThan(55);
    expect(data.bounds.max.y).toBe(0);
    expect(needsframe).not.toHaveBeenCalled();
    object.dispose();
  });

  gpuTest('that are posed before are shown at once, and sought where they are', async () => {
    const { data, object, group, bones, skeleton, cloud } = await scene();
    bones[1].rotation.z = Math.PI / 2;
    group.updateMatrixWorld(true);
    bindSkeleton(object, skeleton, WEIGHTS, object.matrixWorld);
    await isFollowing(cloud);
    await expect.poll(() => cloud.isHeld).toBe(false);
    expect(await psnrDb(cloud, setOf(TURNED))).toBeGreaterThan(55);
    expect([...(await data.rowsIn(new Sphere(new Vector3(0, 0.8, 0), 0.1)))]).toEqual([1]);
    object.dispose();
  });

  gpuTest('of a skeleton in the space of the cloud need no matrix', async () => {
    const { object, group, bones, skeleton, cloud } = await scene();
    // Inverses of bones in the space of the cloud, as files have them.
    for (const inverse of skeleton.boneInverses) inverse.multiply(object.matrixWorld);
    bones[1].rotation.z = Math.PI / 2;
    group.updateMatrixWorld(true);
    bindSkeleton(object, skeleton, WEIGHTS);
    await isFollowing(cloud);
    await expect.poll(() => cloud.isHeld).toBe(false);
    expect(await psnrDb(cloud, setOf(TURNED))).toBeGreaterThan(55);
    object.dispose();
  });

  gpuTest('may be bound again, to another skeleton, with the same weights', async () => {
    const { object, group, bones, skeleton, cloud } = await scene();
    bindSkeleton(object, skeleton, WEIGHTS, object.matrixWorld);
    bindSkeleton(object, skeleton, { ...WEIGHTS }, object.matrixWorld);
    await isFollowing(cloud);
    const others = new Skeleton(bones.map((bone) => bone.clone(false) as Bone));
    group.add(...others.bones);
    group.updateMatrixWorld(true);
    bindSkeleton(object, others, WEIGHTS, object.matrixWorld);
    others.bones[1].rotation.z = Math.PI / 2;
    group.updateMatrixWorld(true);
    await expect.poll(() => psnrDb(cloud, setOf(TURNED))).toBeGreaterThan(55);
    object.dispose();
  });

  gpuTest('are refused without data, for other weights or bones, edits and morphs', async () => {
    const { data, object, skeleton } = await scene();
    expect(() => bindSkeleton(new SplatCloudObject(), skeleton, WEIGHTS)).toThrow(/no data/);
    expect(() => bindSkeleton(object, {} as Skeleton, WEIGHTS)).toThrow(/no list of bones/);
    expect(() => bindSkeleton(object, skeleton, { ...WEIGHTS, weights: [1] })).toThrow(InvalidArgumentError);
    bindSkeleton(object, skeleton, WEIGHTS, object.matrixWorld);
    const others = { ...WEIGHTS, weights: [...WEIGHTS.weights] };
    expect(() => bindSkeleton(object, skeleton, others)).toThrow(/arm has other weights/);
    expect(() => bindSkeleton(object, new Skeleton([new Bone()]), WEIGHTS)).toThrow(/has 1 bones; arm .* 2/);
    expect(() => editsOf(data)).toThrow(/arm has a skeleton/);
    const edited = new SplatCloudObject(makeSplatData(ARRAYS, { name: 'edited' }));
    editsOf(edited.data!);
    expect(() => bindSkeleton(edited, skeleton, WEIGHTS)).toThrow(/edited has edits/);
    const morph = new SplatCloudObject(makeMorphData(ARRAYS, TURNED));
    expect(() => bindSkeleton(morph, skeleton, WEIGHTS)).toThrow(/is a morph/);
  });

  gpuTest('with too few weights are told to objects', async () => {
    const { object, skeleton } = await scene();
    const told: Error[] = [];
    object.onError = (error) => told.push(error);
    const fewer = { indices: [0, 0, 0, 0], weights: [1, 0, 0, 0] };
    bindSkeleton(object, skeleton, fewer);
    await expect.poll(() => told).toHaveLength(1);
    expect(told[0].message).toMatch(/2 rows and the skin 1/);
    object.dispose();
  });
});
