// Proves: an effect finds the row of each splat in its file, wherever the splat is stored.
import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { beforeAll, describe, expect } from 'vitest';
import type { SplatCloud } from '../../clouds/splat-cloud.ts';
import { SplatEngine } from '../../create-engine.ts';
import { brickSceneOf } from '../../data/bricks/make-bricks.ts';
import { perspectiveCamera } from '../../data/camera/camera.ts';
import { filterSplats } from '../../data/editing/crop-splats.ts';
import type { SplatSet } from '../../data/splats/splat-set.ts';
import { followEdits } from '../../features/edits/edits.clouds.ts';
import { SplatEdits } from '../../features/edits/splat-edits.data.ts';
import type { Detail } from '../../frame/plan/detail.ts';
import type { CloudInstance } from '../../frame/plan/frame-request.ts';
import { encodePly } from '../../io/formats/ply/write-ply.ts';
import type { ReferenceFunction } from '../../reference/effects/references.ts';
import { compareImages, renderReference } from '../../reference/index.ts';
import { expectAsReference } from '../../testing/expect-as-reference.ts';
import { FIXED_RASTERIZER } from '../../testing/fixed-rasterizer.ts';
import { movingSplats } from '../../testing/moving-splats.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { signalOf } from '../../testing/signal.ts';
import { TEST_MODELS } from '../../testing/test-cameras.ts';
import type { SplatView } from '../../views/splat-view.ts';
import { defineEffect } from './define-effect.ts';
import type { EffectUse } from './effect.ts';
import { effectResources } from './effect-resources.ts';
import { splatRows } from './splat-rows.ts';

const SIZE = { widthPx: 48, heightPx: 48 };
const camera = perspectiveCamera({ position: [0, 0, 4], target: [0, 0, 0], fovYDegrees: 45, aspect: 1 });
const REQUEST = { camera, ...SIZE };

interface RowValues {
  readonly buffer: GPUBuffer;
  readonly values: ArrayLike<number>;
}

/** Fades and tints each splat by the value of its row; splats without a row are red. */
const byRow = defineEffect<RowValues>({
  name: 'test-by-row',
  label: 'Rows',
  about: 'Shows a value per row.',
  hooks: { splat: 'fadeByRow', color: 'tintByRow' },
  rows: splatRows,
  resources: effectResources({ values: 'array<f32>' }, ({ buffer }) => ({ values: buffer })),
  wgsl: `import package::lib::packing::Splat;
import parameters::testByRowValues;
fn fadeByRow(splat: Splat, splatIndex: u32, row: u32) -> Splat {
  if (row == 0xffffffffu) { return splat; }
  var faded = splat;
  faded.opacity *= 1.0 - 0.5 * testByRowValues[row];
  return faded;
}
fn tintByRow(color: vec3f, splat: Splat, splatIndex: u32, centerView: vec3f, row: u32) -> vec3f {
  if (row == 0xffffffffu) { return vec3f(1.0, 0.0, 0.0); }
  return vec3f(0.0, testByRowValues[row], 1.0 - testByRowValues[row]);
}`,
  calledFor: () => 'rows have values',
});

/** Colours rows without a buffer of values: moving clouds have room for none on some devices. */
const stripes = defineEffect<undefined>({
  name: 'test-stripes',
  label: 'Stripes',
  about: 'Colours rows by their remainder.',
  hooks: { color: 'stripedByRow' },
  rows: splatRows,
  wgsl: `import package::lib::packing::Splat;
fn stripedByRow(color: vec3f, splat: Splat, splatIndex: u32, centerView: vec3f, row: u32) -> vec3f {
  return vec3f(f32(row % 7u) / 6.0, 0.5, 0.0);
}`,
  calledFor: () => 'rows have colours',
});

const effectReferences: Record<string, ReferenceFunction> = {
  'test-by-row': ({ values }: RowValues) => ({
    changeSplat: (splat) => ({ ...splat, opacity: splat.opacity * (1 - 0.5 * values[splat.row]) }),
    changeColor: (_, { row }) => [0, values[row], 1 - values[row]],
  }),
  'test-stripes': () => ({ changeColor: (_, { row }) => [(row % 7) / 6, 0.5, 0] }),
};

let device: GPUDevice;
let engine: SplatEngine;
let view: SplatView;
beforeAll(async () => {
  device = await shareTestDevice();
  engine = await SplatEngine.create({
    device,
    accuracy: { ...FIXED_RASTERIZER, preset: 'reference', sortKeyBits: 32 },
  });
  view = engine.createView();
});

/** The effect with a value for each row, so that neighbours in the file differ. */
function valued(count: number, step: number): EffectUse {
  const values = Float32Array.from({ length: count }, (_, row) => ((row * step) % 101) / 100);
  const buffer = device.createBuffer({
    size: values.byteLength,
    usage: GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_DST,
  });
  device.queue.writeBuffer(buffer, 0, values);
  return byRow({ buffer, values });
}

const setOf = (count: number, seed: number) =>
  randomSplats({ count, seed, shDegree: 1, logScales: [-4, -2] });

async function psnrDb(instance: CloudInstance, sets: readonly SplatSet[], on = view): Promise<number> {
  on.render({ ...REQUEST, clouds: [instance] });
  await on.whenComplete();
  const clouds = sets.map((set, i) => {
    const matrices = instance.instances?.modelMatrices;
    const modelMatrix = matrices && Array.from(matrices).slice(16 * i, 16 * i + 16);
    return { set, modelMatrix, effects: instance.effects };
  });
  const { data } = renderReference({ ...REQUEST, clouds, effectReferences });
  return compareImages((await on.readPixels()).data, data, SIZE).psnrDb;
}

const rowTextures = () => engine.memory().resources.filter(({ label }) => label === 'frame rows');

/** Mean red, green and blue of the pixels that splats cover. */
async function meanColor(cloud: SplatCloud, detail: Detail): Promise<readonly number[]> {
  const own = engine.createView();
  own.render({ ...REQUEST, clouds: [{ cloud, effects: [valued(cloud.count, 1)] }], detail });
  const color = await colorsOf(own);
  own.destroy();
  return color;
}

async function colorsOf(of: SplatView): Promise<readonly number[]> {
  const { data } = await of.readPixels();
  const sums = [0, 0, 0, 0];
  for (const [i, value] of data.entries()) sums[i % 4] += value;
  return sums.slice(0, 3).map((sum) => sum / sums[3]);
}

describe('rows of splats', () => {
  for (const geometryPrecision of ['f32', 'packed'] as const)
    gpuTest(`lead to values by row, in several clouds and on any page: ${geometryPrecision}`, async () => {
      const [first, second] = [setOf(700, 3), setOf(500, 4)];
      const clouds = [
        { set: first, effects: [valued(700, 37)], splatsPerPage: 256 },
        { set: second, modelMatrix: TEST_MODELS.sheared },
        { set: second, modelMatrix: TEST_MODELS.sheared, effects: [valued(500, 53)] },
      ];
      const options = { clouds, effectReferences, accuracy: { geometryPrecision }, ...REQUEST };
      for (const count of await expectAsReference(device, options, 1e-4)) expect(count).toBeGreaterThan(50);
    });

  gpuTest('of moving splats are theirs', async () => {
    const set = movingSplats({ count: 500, seed: 6, shDegree: 1, logScales: [-4, -2] });
    const clouds = [{ set, time: 0.4, effects: [stripes()] }];
    const [count] = await expectAsReference(device, { clouds, effectReferences, ...REQUEST }, 1e-3);
    expect(count).toBeGreaterThan(50);
  });

  gpuTest('are those of the file, in an image of more splats than a line of texels', async () => {
    const set = randomSplats({ count: 9000, seed: 5, shDegree: 1, logScales: [-6, -4] });
    const cloud = await engine.load(new Blob([encodePly(set)]));
    expect([...cloud.fileIndices]).not.toEqual([...cloud.fileIndices].toSorted((a, b) => a - b));
    const effects = [valued(set.count, 37)];
    const { data } = renderReference({ ...REQUEST, clouds: [{ set, effects }], effectReferences });
    const psnrOf = async (drawn: readonly EffectUse[]) => {
      view.render({ ...REQUEST, clouds: [{ cloud, effects: drawn }] });
      await view.whenComplete();
      return compareImages((await view.readPixels()).data, data, SIZE).psnrDb;
    };
    expect(await psnrOf(effects)).toBeGreaterThan(60);
    // Each splat may have a value other than its own: then images differ.
    expect(await psnrOf([valued(set.count, 38)])).toBeLessThan(40);
    cloud.destroy();
  });

  gpuTest('take 4 bytes per splat, once for all instances, while an effect takes them', async () => {
    const set = setOf(600, 6);
    const cloud = engine.add(set);
    const drawPlain = async () => {
      view.render({ ...REQUEST, clouds: [{ cloud }] });
      await view.readPixels();
    };
    await drawPlain();
    expect(rowTextures()).toEqual([]);
    const at = (x: number) => [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, 0, 0, 1];
    // More than one batch holds: the others are behind the camera.
    const hidden = new Array(200).fill([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 50, 1]);
    const instances = { modelMatrices: [at(-0.5), at(0.5), ...hidden].flat() };
    const effects = [valued(600, 37)];
    expect(await psnrDb({ cloud, effects, instances }, [set, set])).toBeGreaterThan(60);
    expect(rowTextures().map(({ bytes }) => bytes)).toEqual([4 * 600]);
    const entry = view.effects().find(({ name }) => name === 'test-by-row');
    expect(entry).toMatchObject({ isOn: true, bytes: 4 * 600, stages: ['cull-splats', 'project'] });
    await drawPlain();
    expect(rowTextures()).toEqual([]);
    cloud.destroy();
  });

  gpuTest('are none for merged splats, and for clouds whose rows are not known', async () => {
    const cloud = engine.add(setOf(2_000, 7));
    await cloud.makeLevels();
    const [red] = await meanColor(cloud, 'full');
    expect(red).toBe(0);
    expect((await meanColor(cloud, { maxErrorPx: 1e6 })).map((value) => Math.round(100 * value))).toEqual([
      100, 0, 0,
    ]);
    cloud.destroy();
    // As previews of a load are.
    const preview = Object.assign(engine.add(setOf(300, 8)), { fileIndices: new Uint32Array(0) });
    expect((await meanColor(preview, 'full'))[0]).toBeCloseTo(1, 2);
    preview.destroy();
  });

  gpuTest('stay when edits hide splats', async () => {
    const set = setOf(600, 10);
    const cloud = engine.add(set);
    const edits = new SplatEdits();
    await followEdits(cloud, edits);
    edits.set(
      Array.from({ length: 300 }, (_, row) => row),
      { visible: false },
    );
    const effects = [valued(set.count, 37)];
    const left = filterSplats(set, (i) => set.fileIndices[i] >= 300);
    expect(await psnrDb({ cloud, effects }, [left])).toBeGreaterThan(60);
    cloud.destroy();
  });

  gpuTest('follow the bricks of a stream', async () => {
    const set = setOf(3_000, 9);
    const scene = brickSceneOf(set);
    const { when, give } = signalOf();
    const cloud = await engine.stream({
      ...scene,
      read: async (address, signal) => {
        if (address.number > 0) await when;
        return scene.read(address, signal);
      },
    });
    const own = engine.createView();
    const effects = [valued(set.count, 37)];
    own.render({ ...REQUEST, clouds: [{ cloud, effects }] });
    expect((await colorsOf(own))[0]).toBeCloseTo(1, 2);
    give();
    expect(await psnrDb({ cloud, effects }, [set], own)).toBeGreaterThan(40);
    for (const each of [own, cloud]) each.destroy();
  });
});
