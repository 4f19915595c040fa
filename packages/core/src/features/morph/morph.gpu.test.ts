import { createTestDevice, gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { beforeAll, describe, expect } from 'vitest';
import { makeRayTree } from '../../clouds/rays/rays.ts';
import type { SplatCloud } from '../../clouds/splat-cloud.ts';
import { SplatEngine } from '../../create-engine.ts';
import type { Accuracy } from '../../data/accuracy/accuracy.ts';
import { perspectiveCamera } from '../../data/camera/camera.ts';
import { DestroyedError, GpuLimitError, InvalidArgumentError, SplatSourceError } from '../../data/errors.ts';
import { packGeometry } from '../../data/packing/geometry.ts';
import { packHarmonics } from '../../data/packing/repack-harmonics.ts';
import { logitOf } from '../../data/splats/color-values.ts';
import type { SplatSet } from '../../data/splats/splat-set.ts';
import { compareImages, renderReference } from '../../reference/index.ts';
import { deviceWith, limitsWith } from '../../testing/device-with.ts';
import { FIXED_RASTERIZER } from '../../testing/fixed-rasterizer.ts';
import { NARROW_REFERENCE } from '../../testing/narrow-reference.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { testCameras } from '../../testing/test-cameras.ts';
import { followEdits } from '../edits/edits.clouds.ts';
import { SplatEdits } from '../edits/splat-edits.data.ts';
import { followMorph } from './morph.clouds.ts';
import { morphGeometry, morphSh } from './morph.reference.ts';
import { SplatMorph } from './splat-morph.data.ts';

const SIZE = { widthPx: 64, heightPx: 64 };
const CAMERA = testCameras(1).perspective;
const COUNT = 1500;
const FROM = randomSplats({ count: COUNT, shDegree: 2, seed: 81, opacityLogits: [0, 4] });
const TO = randomSplats({ count: COUNT, shDegree: 2, seed: 82, logScales: [-4, -1], halfExtent: 0.5 });

let engine: SplatEngine;
beforeAll(async () => {
  const device = await shareTestDevice();
  // Several pages.
  const limits = limitsWith(device, { maxStorageBufferBindingSize: 180 * 512 });
  engine = await SplatEngine.create({ device: deviceWith(device, { limits }) });
});

async function morphing(
  accuracy: Accuracy = NARROW_REFERENCE,
  [from, to]: readonly SplatSet[] = [FROM, TO],
): Promise<{ morph: SplatMorph; cloud: SplatCloud }> {
  const morph = new SplatMorph(from, to, engine.resolveAccuracy(accuracy).settings);
  const cloud = engine.addPacked(morph.packed);
  await followMorph(cloud, morph);
  return { morph, cloud };
}

async function imageOf(
  cloud: SplatCloud,
  accuracy: Accuracy = NARROW_REFERENCE,
  camera = CAMERA,
): Promise<Float32Array> {
  const view = engine.createView();
  view.render({ camera, clouds: [{ cloud }], accuracy, ...SIZE });
  const { data } = await view.readPixels();
  view.destroy();
  return data;
}

/** Float64 blends of the sets' own values, rounded to float32 once. */
function blended(from: SplatSet, to: SplatSet, amount: number): SplatSet {
  const [a, b] = [from, to].map((set) => packGeometry(set, 'f32'));
  const splats = morphGeometry(a, b, from.count, amount);
  const [c, d] = [from, to].map(({ harmonics }) => packHarmonics(harmonics));
  const { degree, words } = morphSh(c, d, from.count, amount);
  return {
    ...from,
    positions: Float32Array.from(splats.flatMap(({ position }) => position)),
    logScales: Float32Array.from(splats.flatMap(({ scale }) => scale.map(Math.log))),
    rotations: Float32Array.from(splats.flatMap(({ rotation }) => rotation)),
    opacityLogits: Float32Array.from(splats, ({ opacity }) => logitOf(opacity)),
    colorDc: Float32Array.from(splats.flatMap(({ colorDc }) => colorDc)),
    harmonics: { degree, coefficients: new Float32Array(words.buffer) },
  };
}

const psnrDb = (actual: Float32Array, expected: Float32Array | Float64Array) =>
  compareImages(actual, expected, SIZE).psnrDb;

function reference(amount: number, camera = CAMERA, sets = [FROM, TO]): Float64Array {
  const [from, to] = sets;
  const set = amount === 0 ? from : amount === 1 ? to : blended(from, to, amount);
  return renderReference({ clouds: [{ set }], camera, ...SIZE }).data as Float64Array;
}

describe('a morphing cloud', () => {
  for (const [name, accuracy, leastDb] of [
    ['reference', NARROW_REFERENCE, 60],
    ['balanced', FIXED_RASTERIZER, 45],
  ] as const) {
    gpuTest(`is drawn as the blend of both sets, ${name}`, async () => {
      const { morph, cloud } = await morphing(accuracy);
      const uploaded = engine.counters().uploadedBytes;
      // Back as well, and to the first set itself.
      for (const amount of [0.3, 1, 0.7, 0]) {
        morph.amount = amount;
        const db = psnrDb(await imageOf(cloud, accuracy), reference(amount));
        expect(db, `${amount}`).toBeGreaterThan(leastDb);
      }
      expect(psnrDb(await imageOf(cloud, accuracy), reference(0.3))).toBeLessThan(40);
      expect(engine.counters().uploadedBytes).toBe(uploaded);
      cloud.destroy();
    });
  }

  gpuTest('is itself again at 0, bit for bit', async () => {
    const { morph, cloud } = await morphing('balanced');
    const before = await imageOf(cloud);
    morph.amount = 1;
    expect(psnrDb(await imageOf(cloud), before)).toBeLessThan(40);
    morph.amount = 0;
    expect(await imageOf(cloud)).toEqual(before);
    cloud.destroy();
  });

  gpuTest('loses no splats that move across the edge of the image', async () => {
    const moved = { ...FROM, positions: FROM.positions.map((value, i) => value + (i % 3 === 0 ? 6 : 0)) };
    const { morph, cloud } = await morphing(NARROW_REFERENCE, [FROM, moved]);
    // At first it sees none of either.
    const camera = perspectiveCamera({
      position: [3, 0, 4],
      target: [3, 0, 0],
      fovYDegrees: 25,
      aspect: 1,
    });
    for (const amount of [0.2, 0.35, 0.5, 0.65]) {
      morph.amount = amount;
      const expected = reference(amount, camera, [FROM, moved]);
      expect(
        expected.some((value) => value > 0),
        `${amount}`,
      ).toBe(true);
      expect(psnrDb(await imageOf(cloud, NARROW_REFERENCE, camera), expected), `${amount}`).toBeGreaterThan(
        60,
      );
    }
    cloud.destroy();
  });

  gpuTest('changes planes that were made for other accuracies', async () => {
    const { morph, cloud } = await morphing(NARROW_REFERENCE);
    await cloud.hold({ geometryPrecision: 'packed', shPrecision: 'u8' }).met;
    expect(cloud.precisions.geometry).toContain('packed');
    morph.amount = 0.3;
    expect(psnrDb(await imageOf(cloud, 'balanced'), reference(0.3))).toBeGreaterThan(45);
    cloud.destroy();
  });

  gpuTest('of sets of different degrees', async () => {
    const flat = randomSplats({ count: COUNT, shDegree: 0, seed: 83 });
    const { morph, cloud } = await morphing(NARROW_REFERENCE, [flat, TO]);
    morph.amount = 1;
    expect(psnrDb(await imageOf(cloud), reference(1))).toBeGreaterThan(60);
    cloud.destroy();
  });

  gpuTest('shows an amount that was set before it was added', async () => {
    const morph = new SplatMorph(FROM, TO, engine.resolveAccuracy('reference').settings);
    morph.amount = 1;
    const cloud = engine.addPacked(morph.packed);
    const following = followMorph(cloud, morph);
    expect(cloud.isHeld).toBe(true);
    await following;
    expect(cloud.isHeld).toBe(false);
    expect(psnrDb(await imageOf(cloud), reference(1))).toBeGreaterThan(60);
    cloud.destroy();
  });

  gpuTest('is drawn in full where less is asked for, and says why', async () => {
    const { morph, cloud } = await morphing();
    morph.amount = 0.3;
    const view = engine.createView();
    view.render({
      camera: CAMERA,
      clouds: [{ cloud }],
      accuracy: NARROW_REFERENCE,
      ...SIZE,
      detail: { maxErrorPx: 4 },
    });
    const { data } = await view.readPixels();
    expect(psnrDb(data, reference(0.3))).toBeGreaterThan(60);
    expect(cloud.levelsLack?.message).toContain('it morphs');
    await expect(cloud.makeLevels()).rejects.toThrow(SplatSourceError);
    const ended = cloud.makeLevels();
    cloud.destroy();
    await expect(ended).rejects.toThrow(DestroyedError);
    view.destroy();
    cloud.destroy();
  });

  gpuTest('is met by rays where it is', async () => {
    const near = { ...FROM, positions: FROM.positions.map((value) => value / 10) };
    const far = { ...near, positions: near.positions.map((value, i) => value + (i % 3 === 2 ? -20 : 0)) };
    const { morph, cloud } = await morphing('balanced', [near, far]);
    morph.amount = 0.5;
    const tree = await makeRayTree(cloud);
    const hit = tree.cast([0, 0, 5], [0, 0, -1]);
    expect(Math.abs(hit!.distance - 15)).toBeLessThan(1);
    cloud.destroy();
  });

  gpuTest('refuses other clouds, edits, and a cloud that has levels', async () => {
    const { morph, cloud } = await morphing();
    await followMorph(cloud, morph);
    await expect(followEdits(cloud, new SplatEdits())).rejects.toThrow('follows a morph');
    const other = engine.add(FROM);
    await expect(followMorph(other, morph)).rejects.toThrow(InvalidArgumentError);
    const edited = engine.addPacked(morph.packed);
    await followEdits(edited, new SplatEdits());
    await expect(followMorph(edited, morph)).rejects.toThrow('follows edits');
    const leveled = engine.addPacked(morph.packed);
    Object.assign(leveled, { levels: { bytes: 0, destroy: () => {} } });
    await expect(followMorph(leveled, morph)).rejects.toThrow(SplatSourceError);
    for (const each of [cloud, other, edited, leveled]) each.destroy();
  });

  gpuTest('frees what it held, and ends with its cloud', async () => {
    const before = engine.memory().totalBytes;
    const { morph, cloud } = await morphing();
    expect(engine.memory().totalBytes).toBeGreaterThan(before + 2 * cloud.bytes);
    cloud.destroy();
    expect(engine.memory().totalBytes).toBe(before);
    const ended = engine.addPacked(morph.packed);
    const following = followMorph(ended, morph);
    ended.destroy();
    await expect(following).rejects.toThrow(DestroyedError);
    expect(engine.memory().totalBytes).toBe(before);
  });

  gpuTest('ends with its engine and its device', async () => {
    for (const end of [(on: SplatEngine) => on.destroy(), (on: SplatEngine) => on.device.destroy()]) {
      const on = await SplatEngine.create({ device: await createTestDevice() });
      const morph = new SplatMorph(FROM, TO, on.accuracy);
      const following = followMorph(on.addPacked(morph.packed), morph);
      end(on);
      await expect(following).rejects.toThrow(DestroyedError);
    }
  });

  gpuTest('stays as its first set where both have no room', async () => {
    const morph = new SplatMorph(FROM, TO, engine.resolveAccuracy('reference').settings);
    const device = await shareTestDevice();
    const small = await SplatEngine.create({ device, memoryBudgetBytes: 600_000 });
    const cloud = small.addPacked(morph.packed);
    const { totalBytes } = small.memory();
    await expect(followMorph(cloud, morph)).rejects.toThrow(GpuLimitError);
    expect(cloud.features).toEqual([]);
    expect(small.memory().totalBytes).toBe(totalBytes);
    small.destroy();
  });
});
