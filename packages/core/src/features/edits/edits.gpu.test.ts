// Proves: edited rows are drawn as splats that were made with these values.
import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { beforeAll, describe, expect } from 'vitest';
import { makeRayTree } from '../../clouds/rays/rays.ts';
import type { SplatCloud } from '../../clouds/splat-cloud.ts';
import { createEngine, SplatEngine } from '../../create-engine.ts';
import type { Accuracy } from '../../data/accuracy/accuracy.ts';
import { perspectiveCamera } from '../../data/camera/camera.ts';
import { DestroyedError, InvalidArgumentError, SplatSourceError } from '../../data/errors.ts';
import { GEOMETRY_WORDS } from '../../data/packing/geometry.ts';
import { packSet } from '../../data/packing/pack-set.ts';
import { colorDcOf, logitOf } from '../../data/splats/color-values.ts';
import { SplatSelection } from '../../data/splats/splat-selection.ts';
import type { SplatSet } from '../../data/splats/splat-set.ts';
import { tint } from '../../gpu/effects/index.ts';
import { encodePly } from '../../io/formats/ply/write-ply.ts';
import { compareImages } from '../../reference/index.ts';
import { deviceWith, limitsWith } from '../../testing/device-with.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { testCameras } from '../../testing/test-cameras.ts';
import { flushEdits, followEdits } from './edits.clouds.ts';
import { type EditedValues, SplatEdits } from './splat-edits.data.ts';

const SIZE = { widthPx: 64, heightPx: 64 };
const CAMERA = testCameras(1).perspective;
const COUNT = 1500;
const SPLATS = randomSplats({ count: COUNT, shDegree: 1, opacityLogits: [0, 4] });
/** Every third row. */
const ROWS = Uint32Array.from({ length: COUNT / 3 }, (_, i) => 3 * i);
const MIN_PSNR_DB = 45;

let device: GPUDevice;
let engine: SplatEngine;
beforeAll(async () => {
  device = await shareTestDevice();
  // Several pages, and rows that are packed on the GPU.
  const limited = deviceWith(device, {
    limits: limitsWith(device, { maxStorageBufferBindingSize: 180 * 512 }),
  });
  engine = await createEngine({ device: limited }, { ingestMinRows: 1 });
});

async function imageOf(cloud: SplatCloud, accuracy?: Accuracy, on = engine): Promise<Float32Array> {
  const view = on.createView();
  view.render({ camera: CAMERA, clouds: [{ cloud }], accuracy, ...SIZE });
  const { data } = await view.readPixels();
  view.destroy();
  return data;
}

async function imageOfSet(set: SplatSet, accuracy?: Accuracy): Promise<Float32Array> {
  const cloud = engine.addPacked(packSet(set, engine.resolveAccuracy(accuracy).settings));
  const image = await imageOf(cloud, accuracy);
  cloud.destroy();
  return image;
}

const psnrDb = (actual: Float32Array, expected: Float32Array) => compareImages(actual, expected, SIZE).psnrDb;

/** Random values for `ROWS`. */
const VALUES: Readonly<Record<string, EditedValues>> = (() => {
  const random = seededRandom(7);
  const column = (width: number, min: number, max: number) =>
    Float32Array.from({ length: width * ROWS.length }, () => min + (max - min) * random());
  return {
    positions: { positions: column(3, -1.2, 1.2) },
    scales: { scales: column(3, 0.01, 0.1) },
    'scales outside of the range': { scales: column(3, 0.2, 0.4) },
    rotations: { rotations: column(4, -1, 1) },
    opacities: { opacities: column(1, 0, 1) },
    colors: { colors: column(3, 0, 1) },
    visibility: { visible: false },
    'one value for all': { colors: [1, 0, 0], opacities: [0.5] },
  };
})();

/** The set as a file with the values in it would hold it. */
function withValues(set: SplatSet, values: EditedValues, rows: Iterable<number> = ROWS): SplatSet {
  const { positions, scales, rotations, opacities, colors, visible } = values;
  const changed: SplatSet = {
    ...set,
    positions: set.positions.slice(),
    logScales: set.logScales.slice(),
    rotations: set.rotations.slice(),
    opacityLogits: set.opacityLogits.slice(),
    colorDc: set.colorDc.slice(),
  };
  const at = (array: ArrayLike<number>, width: number, i: number, k: number) =>
    array[(array.length === width ? 0 : width * i) + k];
  for (const [i, row] of [...rows].entries()) {
    for (let k = 0; k < 3; k++) {
      if (positions) changed.positions[3 * row + k] = at(positions, 3, i, k) - set.origin[k];
      if (scales) changed.logScales[3 * row + k] = Math.log(at(scales, 3, i, k));
      if (colors) changed.colorDc[3 * row + k] = colorDcOf(at(colors, 3, i, k));
    }
    for (let k = 0; rotations && k < 4; k++)
      changed.rotations[4 * row + ((k + 1) % 4)] = at(rotations, 4, i, k);
    if (opacities) changed.opacityLogits[row] = logitOf(at(opacities, 1, i, 0));
    if (visible === false) changed.opacityLogits[row] = Number.NEGATIVE_INFINITY;
  }
  return changed;
}

describe('an edited cloud is drawn as one that was made with these values', () => {
  for (const [name, values] of Object.entries(VALUES)) {
    gpuTest(`${name}, packed`, async () => {
      const cloud = engine.add(SPLATS);
      const edits = new SplatEdits(COUNT);
      await followEdits(cloud, edits);
      const before = await imageOf(cloud);
      edits.set(ROWS, values);
      const edited = await imageOf(cloud);
      expect(psnrDb(edited, before)).toBeLessThan(40);
      expect(psnrDb(edited, await imageOfSet(withValues(SPLATS, values)))).toBeGreaterThan(MIN_PSNR_DB);
      edits.reset();
      expect(await imageOf(cloud)).toEqual(before);
      cloud.destroy();
    });
  }

  gpuTest('all of them, f32', async () => {
    const { positions, scales, rotations, opacities, colors } = VALUES;
    const values = { ...positions, ...scales, ...rotations, ...opacities, ...colors };
    const cloud = engine.addPacked(packSet(SPLATS, engine.resolveAccuracy('high').settings));
    const edits = new SplatEdits(COUNT);
    edits.set(ROWS, values);
    await followEdits(cloud, edits);
    const expected = await imageOfSet(withValues(SPLATS, values), 'high');
    expect(psnrDb(await imageOf(cloud, 'high'), expected)).toBeGreaterThan(60);
    cloud.destroy();
  });

  gpuTest('several edits after one another, of ranges, lists and selections', async () => {
    const cloud = engine.add(SPLATS);
    const edits = new SplatEdits();
    await followEdits(cloud, edits);
    const selection = new SplatSelection();
    selection.add([5, 33, 1499]);
    edits.set({ first: 10, count: 600 }, { colors: [0, 1, 0], visible: false });
    edits.set([20, 700], { colors: [1, 1, 1, 0, 0, 0] });
    edits.set({ first: 0, count: 300 }, { visible: true });
    edits.set(selection, { positions: PLACES, scales: [0.1, 0.1, 0.1] });
    // At different depths: where these are equal, the order of storage decides.
    let expected = withValues(SPLATS, { colors: [0, 1, 0] }, range(10, 610));
    expected = withValues(expected, { colors: [1, 1, 1, 0, 0, 0] }, [20, 700]);
    expected = withValues(expected, { visible: false }, range(300, 610));
    expected = withValues(expected, { positions: PLACES, scales: [0.1, 0.1, 0.1] }, [5, 33, 1499]);
    expect(psnrDb(await imageOf(cloud), await imageOfSet(expected))).toBeGreaterThan(MIN_PSNR_DB);
    cloud.destroy();
  });

  gpuTest('far from the origin, where float32 loses the digits of positions', async () => {
    const origin = [4e6, -2e6, 1e6] as const;
    const far = { ...SPLATS, origin };
    const cloud = engine.add(far);
    const edits = new SplatEdits(COUNT);
    await followEdits(cloud, edits);
    const moved = [4e6 + 0.1, -2e6 + 0.2, 1e6 - 0.1];
    edits.set({ first: 0, count: 4 }, { positions: moved, scales: [0.1, 0.1, 0.1] });
    const view = engine.createView();
    const camera = perspectiveCamera({
      position: [origin[0] + 1, origin[1] + 1, origin[2] + 2],
      target: origin,
      aspect: 1,
      near: 0.1,
      far: 100,
      fovYDegrees: 50,
    });
    view.render({ camera, clouds: [{ cloud }], ...SIZE });
    const { data } = await view.readPixels();
    cloud.destroy();
    const made = engine.add(withValues(far, { positions: moved, scales: [0.1, 0.1, 0.1] }, [0, 1, 2, 3]));
    view.render({ camera, clouds: [{ cloud: made }], ...SIZE });
    expect(psnrDb(data, (await view.readPixels()).data)).toBeGreaterThan(MIN_PSNR_DB);
    view.destroy();
    made.destroy();
  });
});

/** Places of three splats. */
const PLACES = [0, 0, 0, 0.2, 0.1, 0.1, -0.1, 0.3, 0.2];

const range = (from: number, to: number) => Array.from({ length: to - from }, (_, i) => from + i);

describe('an edit', () => {
  gpuTest('uploads the changed splats, in one range if they lie close together', async () => {
    const cloud = engine.add(SPLATS);
    const edits = new SplatEdits(COUNT);
    await followEdits(cloud, edits);
    const uploadedBy = async (edit: () => void) => {
      const before = engine.counters().uploadedBytes;
      edit();
      await imageOf(cloud);
      return engine.counters().uploadedBytes - before;
    };
    const splatBytes = 4 * GEOMETRY_WORDS.packed;
    const row = cloud.fileIndices[7];
    const next = cloud.fileIndices[9];
    const distant = cloud.fileIndices[400];
    expect(await uploadedBy(() => edits.set([], { colors: [1, 1, 1] }))).toBe(0);
    expect(await uploadedBy(() => edits.set([row], { colors: [1, 1, 1] }))).toBe(splatBytes);
    expect(await uploadedBy(() => {})).toBe(0);
    // With the splat between them.
    expect(await uploadedBy(() => edits.set([row, next], { opacities: [0.2] }))).toBe(3 * splatBytes);
    expect(await uploadedBy(() => edits.set([row, distant], { visible: false }))).toBe(2 * splatBytes);
    // A chunk's bounds besides.
    expect(await uploadedBy(() => edits.set([row], { positions: [0, 0, 0] }))).toBe(splatBytes + 32);
    const all = { first: 0, count: COUNT };
    expect(await uploadedBy(() => edits.set(all, { colors: [1, 0, 0] }))).toBe(COUNT * splatBytes);
    cloud.destroy();
  });

  gpuTest('draws a view at rest again, once', async () => {
    const cloud = engine.add(SPLATS);
    const edits = new SplatEdits(COUNT);
    await followEdits(cloud, edits);
    const view = engine.createView();
    const frame = { camera: CAMERA, clouds: [{ cloud, effects: [tint([1, 0.9, 0.8])] }], ...SIZE };
    view.render(frame);
    await view.whenDrawn();
    edits.set(ROWS, { colors: [1, 0, 0] });
    expect(view.render(frame)).toBe(true);
    expect(view.render(frame)).toBe(false);
    const { data } = await view.readPixels();
    const made = engine.add(withValues(SPLATS, { colors: [1, 0, 0] }));
    const other = engine.createView();
    other.render({ ...frame, clouds: [{ ...frame.clouds[0], cloud: made }] });
    expect(psnrDb(data, (await other.readPixels()).data)).toBeGreaterThan(MIN_PSNR_DB);
    for (const each of [view, other, cloud, made]) each.destroy();
  });

  gpuTest('moves bounds, picks and rays', async () => {
    const cloud = engine.add(SPLATS);
    const edits = new SplatEdits(COUNT);
    await followEdits(cloud, edits);
    edits.set({ first: 0, count: COUNT }, { visible: false });
    edits.set([42], { positions: [8, 0, 0], scales: [0.5, 0.5, 0.5], opacities: [1], visible: true });
    const tree = await makeRayTree(cloud);
    expect(tree.cast([8, 0, 10], [0, 0, -1])?.distance).toBeCloseTo(10, 1);
    expect(tree.cast([0, 0, 10], [0, 0, -1])).toBeNull();
    const view = engine.createView();
    const camera = perspectiveCamera({
      position: [8, 0, 10],
      target: [8, 0, 0],
      aspect: 1,
      near: 0.1,
      far: 100,
      fovYDegrees: 50,
    });
    view.render({ camera, clouds: [{ cloud }], ...SIZE });
    expect((await view.pick(32, 32))?.row).toBe(42);
    expect(cloud.bounds.max[0]).toBe(8);
    expect(cloud.robustBounds.max[0]).toBeLessThan(1.1);
    view.destroy();
    cloud.destroy();
  });

  gpuTest('shows on every engine, also on one that gets the splats later', async () => {
    const values = VALUES.positions;
    const edits = new SplatEdits(COUNT);
    const clouds = [engine.add(SPLATS)];
    await followEdits(clouds[0], edits);
    edits.set(ROWS, values);
    const other = await SplatEngine.create({ device });
    clouds.push(other.add(SPLATS));
    await followEdits(clouds[1], edits);
    edits.set([1, 2], { colors: [1, 1, 0], scales: [0.2, 0.2, 0.2] });
    const images = [await imageOf(clouds[0]), await imageOf(clouds[1], undefined, other)];
    expect(psnrDb(images[0], images[1])).toBeGreaterThan(80);
    clouds[0].destroy();
    edits.set([1, 2], { visible: false });
    expect(psnrDb(await imageOf(clouds[1], undefined, other), images[1])).toBeLessThan(60);
    other.destroy();
    // Buffers that the engine has freed are not written; the device would complain.
    await Promise.resolve();
    edits.set([1, 2], { visible: true });
    flushEdits(clouds[1]);
  });

  gpuTest('lasts through finer and coarser precisions, and files are read again unedited', async () => {
    const file = new Blob([encodePly(SPLATS)]);
    const cloud = await engine.load(file);
    const edits = new SplatEdits(COUNT);
    await followEdits(cloud, edits);
    const values = { ...VALUES.positions, ...VALUES.scales, ...VALUES.colors };
    edits.set(ROWS, values);
    await imageOf(cloud);
    await engine.requestPrecision(cloud, { geometryPrecision: 'f32', shPrecision: 'f16' });
    const expected = await imageOfSet(withValues(SPLATS, values), 'high');
    expect(psnrDb(await imageOf(cloud, 'high'), expected)).toBeGreaterThan(60);
    await engine.requestPrecision(cloud, { geometryPrecision: 'packed', shPrecision: 'u8' });
    const coarse = await imageOfSet(withValues(SPLATS, values));
    expect(psnrDb(await imageOf(cloud), coarse)).toBeGreaterThan(MIN_PSNR_DB);
    edits.reset();
    expect(psnrDb(await imageOf(cloud), await imageOfSet(SPLATS))).toBeGreaterThan(MIN_PSNR_DB);
    cloud.destroy();
  });

  gpuTest('gives balls sizes of their own, and their rotations show', async () => {
    const sphere = (set: SplatSet) => ({
      ...set,
      logScales: set.logScales.map((_, i) => set.logScales[3 * Math.floor(i / 3)]),
    });
    const balls = sphere(SPLATS);
    const cloud = engine.add(balls);
    const edits = new SplatEdits(COUNT);
    await followEdits(cloud, edits);
    const view = engine.createView();
    const frame = { camera: CAMERA, clouds: [{ cloud }], ...SIZE };
    view.render(frame);
    await view.whenDrawn();
    edits.set(ROWS, VALUES.scales);
    view.render(frame);
    await expect.poll(() => cloud.facts.isIsotropic).toBe(false);
    view.render(frame);
    const expected = await imageOfSet(withValues(balls, VALUES.scales));
    expect(psnrDb((await view.readPixels()).data, expected)).toBeGreaterThan(MIN_PSNR_DB);
    view.destroy();
    cloud.destroy();
  });

  gpuTest('is refused for previews, destroyed clouds, and clouds with other edits', async () => {
    const refused: Promise<unknown>[] = [];
    const cloud = await engine.load(new Blob([encodePly(SPLATS)]), {
      onPreview: (preview) => {
        refused.push(followEdits(preview, new SplatEdits()));
        // Awaited after the load.
        refused.at(-1)!.catch(() => {});
      },
    });
    await expect(refused[0]).rejects.toThrow(SplatSourceError);
    const edits = new SplatEdits();
    await Promise.all([followEdits(cloud, edits), followEdits(cloud, edits)]);
    await expect(followEdits(cloud, new SplatEdits())).rejects.toThrow(InvalidArgumentError);
    const late = engine.add(SPLATS);
    const following = followEdits(late, edits);
    late.destroy();
    await expect(following).rejects.toThrow(DestroyedError);
    cloud.destroy();
    await expect(followEdits(cloud, edits)).rejects.toThrow(DestroyedError);
    expect(() => edits.set([0], { visible: false })).not.toThrow();
  });
});
