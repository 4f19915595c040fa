import { createTestDevice, gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { beforeAll, describe, expect } from 'vitest';
import { makeRayTree } from '../../clouds/rays/rays.ts';
import type { SplatCloud } from '../../clouds/splat-cloud.ts';
import { SplatEngine } from '../../create-engine.ts';
import type { Accuracy } from '../../data/accuracy/accuracy.ts';
import { perspectiveCamera } from '../../data/camera/camera.ts';
import { DestroyedError, GpuLimitError, InvalidArgumentError, SplatSourceError } from '../../data/errors.ts';
import { packGeometry } from '../../data/packing/geometry.ts';
import type { SplatSet } from '../../data/splats/splat-set.ts';
import { compareImages, renderReference } from '../../reference/index.ts';
import { deviceWith, limitsWith } from '../../testing/device-with.ts';
import { FIXED_RASTERIZER } from '../../testing/fixed-rasterizer.ts';
import { NARROW_REFERENCE } from '../../testing/narrow-reference.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { testCameras } from '../../testing/test-cameras.ts';
import { followEdits } from '../edits/edits.clouds.ts';
import { SplatEdits } from '../edits/splat-edits.data.ts';
import { followMorph } from '../morph/morph.clouds.ts';
import { SplatMorph } from '../morph/splat-morph.data.ts';
import { followSkin } from './skin.clouds.ts';
import { skinGeometry } from './skin.reference.ts';
import { SplatSkin } from './splat-skin.data.ts';

const SIZE = { widthPx: 64, heightPx: 64 };
const CAMERA = testCameras(1).perspective;
const COUNT = 1500;
const SET = randomSplats({ count: COUNT, shDegree: 1, seed: 81, opacityLogits: [0, 4] });
/** The left follows one joint, the right another, with a soft transition between them. */
const WEIGHTS = {
  indices: Array.from({ length: 4 * COUNT }, (_, k) => (k % 4 === 1 ? 1 : 0)),
  weights: Array.from({ length: 4 * COUNT }, (_, k) => {
    const right = Math.min(1, Math.max(0, 0.5 + SET.positions[3 * Math.floor(k / 4)]));
    return [1 - right, right, 0, 0][k % 4];
  }),
};
const STILL = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
/** Turned by 50 degrees about z, stretched along y, and moved. */
const BENT = [0.643, 0.766, 0, 0, -0.92, 0.77, 0, 0, 0, 0, 1, 0, 0.1, -0.2, 0.1, 1];
const BEND = [...STILL, ...BENT];

let engine: SplatEngine;
beforeAll(async () => {
  const device = await shareTestDevice();
  // Several pages.
  const limits = limitsWith(device, { maxStorageBufferBindingSize: 80 * 1024 });
  engine = await SplatEngine.create({ device: deviceWith(device, { limits }) });
});

async function skinned(accuracy: Accuracy = NARROW_REFERENCE, set: SplatSet = SET, weights = WEIGHTS) {
  const on = await SplatEngine.create({ device: engine.device, accuracy });
  const cloud = on.add(set);
  const skin = new SplatSkin(weights, 2);
  await followSkin(cloud, skin);
  return { skin, cloud, on };
}

async function imageOf(on: SplatEngine, cloud: SplatCloud, accuracy?: Accuracy, camera = CAMERA) {
  const view = on.createView();
  view.render({ camera, clouds: [{ cloud }], ...(accuracy && { accuracy }), ...SIZE });
  const { data } = await view.readPixels();
  view.destroy();
  return data;
}

/** The set as float64 moves it. */
function posed(pose: readonly number[], set: SplatSet = SET, weights = WEIGHTS): SplatSet {
  const { words } = new SplatSkin(weights, 2);
  const rows = [0, 16].flatMap((at) =>
    [0, 1, 2].flatMap((row) => [0, 4, 8, 12].map((column) => pose[at + column + row])),
  );
  const splats = skinGeometry(packGeometry(set, 'f32'), words, rows, set.count);
  return {
    ...set,
    positions: Float32Array.from(splats.flatMap(({ position }) => position)),
    logScales: Float32Array.from(splats.flatMap(({ scale }) => scale.map(Math.log))),
    rotations: Float32Array.from(splats.flatMap(({ rotation }) => rotation)),
  };
}

const psnrDb = (actual: Float32Array, expected: Float32Array | Float64Array) =>
  compareImages(actual, expected, SIZE).psnrDb;

const reference = (set: SplatSet, camera = CAMERA) =>
  renderReference({ clouds: [{ set }], camera, ...SIZE }).data as Float64Array;

describe('a cloud with a skin', () => {
  for (const [name, accuracy, leastDb] of [
    ['reference', NARROW_REFERENCE, 60],
    ['balanced', FIXED_RASTERIZER, 45],
  ] as const)
    gpuTest(`is drawn as float64 moves it, ${name}, and at rest bit for bit as before`, async () => {
      const { skin, cloud, on } = await skinned(accuracy);
      const before = await imageOf(on, cloud);
      skin.setPose(BEND);
      const bent = await imageOf(on, cloud);
      expect(psnrDb(bent, reference(posed(BEND)))).toBeGreaterThan(leastDb);
      expect(psnrDb(bent, before)).toBeLessThan(35);
      const uploaded = on.counters().uploadedBytes;
      expect(await imageOf(on, cloud)).toEqual(bent);
      expect(on.counters().uploadedBytes).toBe(uploaded);
      skin.setPose([...STILL, ...STILL]);
      expect(await imageOf(on, cloud)).toEqual(before);
      on.destroy();
    });

  gpuTest('uploads matrices and chunks alone', async () => {
    const { skin, cloud, on } = await skinned();
    await imageOf(on, cloud);
    const { uploadedBytes } = on.counters();
    skin.setPose(BEND);
    await imageOf(on, cloud);
    expect(on.counters().uploadedBytes - uploadedBytes).toBe(2 * 48 + 32 * Math.ceil(COUNT / 256));
    on.destroy();
  });

  gpuTest('asks for the pose before each frame', async () => {
    const { skin, cloud, on } = await skinned();
    let asked = 0;
    skin.beforeFrame = () => {
      asked++;
      skin.setPose(BEND);
    };
    expect(psnrDb(await imageOf(on, cloud), reference(posed(BEND)))).toBeGreaterThan(60);
    expect(asked).toBeGreaterThan(0);
    on.destroy();
  });

  gpuTest('shows a pose that was set before', async () => {
    const cloud = engine.add(SET);
    const skin = new SplatSkin(WEIGHTS, 2);
    skin.setPose(BEND);
    const following = followSkin(cloud, skin);
    expect(cloud.isHeld).toBe(true);
    await following;
    expect(cloud.isHeld).toBe(false);
    expect(psnrDb(await imageOf(engine, cloud, 'balanced'), reference(posed(BEND)))).toBeGreaterThan(45);
    cloud.destroy();
  });

  gpuTest('loses no splats that joints move into the image', async () => {
    const { skin, cloud, on } = await skinned();
    const camera = perspectiveCamera({ position: [9, 0, 4], target: [9, 0, 0], fovYDegrees: 30, aspect: 1 });
    expect(Math.max(...(await imageOf(on, cloud, NARROW_REFERENCE, camera)))).toBe(0);
    const pose = [...STILL, ...BENT.with(12, 9)];
    skin.setPose(pose);
    const expected = reference(posed(pose), camera);
    expect(Math.max(...expected)).toBeGreaterThan(0.1);
    expect(psnrDb(await imageOf(on, cloud, NARROW_REFERENCE, camera), expected)).toBeGreaterThan(60);
    const { positions } = posed(pose);
    for (let i = 0; i < positions.length; i++) {
      expect(positions[i]).toBeGreaterThanOrEqual(cloud.bounds.min[i % 3]);
      expect(positions[i]).toBeLessThanOrEqual(cloud.bounds.max[i % 3]);
    }
    expect(cloud.bounds.max[0]).toBeLessThan(14);
    on.destroy();
  });

  gpuTest('turns balls to ellipsoids', async () => {
    const balls = { ...SET, logScales: SET.logScales.map((_, k) => SET.logScales[3 * Math.floor(k / 3)]) };
    const { skin, cloud, on } = await skinned(NARROW_REFERENCE, balls);
    skin.setPose(BEND);
    expect(psnrDb(await imageOf(on, cloud), reference(posed(BEND, balls)))).toBeGreaterThan(60);
    on.destroy();
  });

  gpuTest('far from the origin is as near it', async () => {
    const far = { ...SET, origin: [1e5, 0, -1e5] as const };
    const { skin, cloud, on } = await skinned(NARROW_REFERENCE, far);
    // The same bend, about the set's own origin.
    const bent = BENT.slice();
    for (let axis = 0; axis < 3; axis++)
      bent[12 + axis] += far.origin[axis] - (BENT[axis] * far.origin[0] + BENT[8 + axis] * far.origin[2]);
    skin.setPose([...STILL, ...bent]);
    const modelMatrix = [...STILL.slice(0, 12), -1e5, 0, 1e5, 1];
    const view = on.createView();
    view.render({ camera: CAMERA, clouds: [{ cloud, modelMatrix }], ...SIZE });
    const { data } = await view.readPixels();
    expect(psnrDb(data, reference(posed(BEND)))).toBeGreaterThan(60);
    on.destroy();
  });

  gpuTest('moves planes that are made later, finer and coarser ones', async () => {
    const { skin, cloud, on } = await skinned('balanced');
    skin.setPose(BEND);
    await imageOf(on, cloud);
    await cloud.hold({ geometryPrecision: 'f32', shPrecision: 'f32' }).met;
    expect(psnrDb(await imageOf(on, cloud, NARROW_REFERENCE), reference(posed(BEND)))).toBeGreaterThan(60);
    const pose = [...BENT, ...STILL];
    skin.setPose(pose);
    expect(psnrDb(await imageOf(on, cloud, NARROW_REFERENCE), reference(posed(pose)))).toBeGreaterThan(60);
    await cloud.hold({ geometryPrecision: 'packed', shPrecision: 'u8' }).met;
    expect(psnrDb(await imageOf(on, cloud, 'balanced'), reference(posed(pose)))).toBeGreaterThan(45);
    on.destroy();
  });

  gpuTest('is met by rays where it is', async () => {
    const near = { ...SET, positions: SET.positions.map((value) => value / 10) };
    const { skin, cloud, on } = await skinned('balanced', near);
    const back = STILL.with(14, -10);
    skin.setPose([...back, ...back]);
    const tree = await makeRayTree(cloud);
    expect(Math.abs(tree.cast([0, 0, 5], [0, 0, -1])!.distance - 15)).toBeLessThan(1);
    on.destroy();
  });

  gpuTest('refuses other skins, edits, morphs, levels, and a skin that lacks rows', async () => {
    const { skin, cloud, on } = await skinned();
    await followSkin(cloud, skin);
    await expect(followSkin(cloud, new SplatSkin(WEIGHTS, 2))).rejects.toThrow('follows a skin');
    await expect(followEdits(cloud, new SplatEdits())).rejects.toThrow('follows a skin');
    await expect(cloud.makeLevels()).rejects.toThrow('joints move it');
    const edited = on.add(SET);
    await followEdits(edited, new SplatEdits());
    await expect(followSkin(edited, skin)).rejects.toThrow(InvalidArgumentError);
    await expect(followSkin(edited, skin)).rejects.toThrow('follows edits');
    const morph = new SplatMorph(SET, SET, on.accuracy);
    const morphing = on.addPacked(morph.packed);
    await followMorph(morphing, morph);
    await expect(followSkin(morphing, skin)).rejects.toThrow('follows a morph');
    const fewer = { indices: WEIGHTS.indices.slice(4), weights: WEIGHTS.weights.slice(4) };
    await expect(followSkin(on.add(SET), new SplatSkin(fewer, 2))).rejects.toThrow(
      /has 1500 rows and the skin 1499/,
    );
    const leveled = on.add(SET);
    Object.assign(leveled, { levels: { bytes: 0, destroy: () => {} } });
    await expect(followSkin(leveled, skin)).rejects.toThrow(SplatSourceError);
    on.destroy();
  });

  gpuTest('frees what it held, and ends with its cloud, its engine and its device', async () => {
    const before = engine.memory().totalBytes;
    const cloud = engine.add(SET);
    const alone = engine.memory().totalBytes - before;
    const skin = new SplatSkin(WEIGHTS, 2);
    await followSkin(cloud, skin);
    const held = engine.memory().totalBytes - before - alone;
    expect(held).toBeGreaterThanOrEqual((32 + 8) * COUNT);
    expect(held).toBeLessThan((32 + 8) * COUNT + 1000);
    cloud.destroy();
    expect(engine.memory().totalBytes).toBe(before);
    const ended = engine.add(SET);
    const following = followSkin(ended, skin);
    ended.destroy();
    await expect(following).rejects.toThrow(DestroyedError);
    expect(engine.memory().totalBytes).toBe(before);
    for (const end of [(on: SplatEngine) => on.destroy(), (on: SplatEngine) => on.device.destroy()]) {
      const on = await SplatEngine.create({ device: await createTestDevice() });
      const waiting = followSkin(on.add(SET), skin);
      end(on);
      await expect(waiting).rejects.toThrow(DestroyedError);
    }
  });

  gpuTest('stays at rest where memory is lacking', async () => {
    const small = await SplatEngine.create({ device: engine.device, memoryBudgetBytes: 100_000 });
    const cloud = small.add(SET);
    const { totalBytes } = small.memory();
    await expect(followSkin(cloud, new SplatSkin(WEIGHTS, 2))).rejects.toThrow(GpuLimitError);
    expect(cloud.features).toEqual([]);
    expect(small.memory().totalBytes).toBe(totalBytes);
    small.destroy();
  });
});
