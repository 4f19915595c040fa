// Proves: presets reach their PSNR against float64; engines count what they hold and do.
import { createNodeGpu } from '@websplatter/node';
import { createTestDevice, gpuTest, shareBlendingDevice, shareTestDevice } from '@websplatter/node/gpu-test';
import { beforeAll, describe, expect } from 'vitest';
import { SplatCloud } from './clouds/splat-cloud.ts';
import { createEngine, SplatEngine } from './create-engine.ts';
import type { Accuracy } from './data/accuracy/accuracy.ts';
import { cameraFromMatrices, perspectiveCamera } from './data/camera/camera.ts';
import { DestroyedError, GpuLimitError, InvalidArgumentError } from './data/errors.ts';
import { Chunk } from './data/layout/structs.ts';
import { type Mat4, translated4 } from './data/math/mat4.ts';
import { packCloud } from './data/packing/packed-cloud.ts';
import type { ShDegree } from './data/splats/splat-set.ts';
import type { FrameRequest } from './frame/plan/frame-request.ts';
import { GpuMemory } from './gpu/gpu-memory.ts';
import type { FrameStatistics } from './gpu/timing/frame-statistics.ts';
import { encodePly } from './io/formats/ply/write-ply.ts';
import { compareImages, renderReference } from './reference/index.ts';
import { deviceWith, limitsWith, onOwnAdapter, withAdapter } from './testing/device-with.ts';
import { objectScene } from './testing/object-scene.ts';
import { ownHarmonics } from './testing/own-harmonics.ts';
import {
  byTiles,
  draw,
  drawAlone,
  expectObjectAccurate,
  expectPresetsAccurate,
  MIN_PSNR_DB,
  type PresetEngines,
  presetEngines,
  type Scene,
} from './testing/preset-engines.ts';
import { randomSplats, splatsOf } from './testing/random-splats.ts';
import { TEST_MODELS, testCameras } from './testing/test-cameras.ts';

const isFull = process.env.WEBSPLATTER_FULL === '1';

const SIZE = { widthPx: 64, heightPx: 64 };
const CAMERAS = testCameras(1);
const CAMERA = CAMERAS.perspective;

let device: GPUDevice;
let canBlendFloat32: boolean;
let engines: PresetEngines;

beforeAll(async () => {
  device = await shareBlendingDevice();
  canBlendFloat32 = device.features.has('float32-blendable' as GPUFeatureName);
  engines = await presetEngines(device);
});

const drawScene = (engine: SplatEngine, scene: Scene) => drawAlone(engine, scene, SIZE);
const expectAccurate = (scene: Scene) => expectPresetsAccurate(engines, scene, SIZE);

const smallScene: Scene = { clouds: [{ set: randomSplats({ count: 600 }) }], camera: CAMERA };

describe('images against the float64 reference', () => {
  for (const [name, camera] of Object.entries(CAMERAS)) {
    gpuTest(`${name} camera`, () => expectAccurate({ ...smallScene, camera }));
  }

  for (const shDegree of [0, 1, 2, 3] as const) {
    gpuTest(`harmonics of degree ${shDegree}`, () =>
      expectAccurate({ clouds: [{ set: randomSplats({ count: 600, shDegree }) }], camera: CAMERA }),
    );
  }

  gpuTest('clouds of degree 3, each drawn up to its own degree', () => {
    const clouds = ([0, 1, 2, 3, undefined] as const).map((shDegree, i) => ({
      set: randomSplats({ count: 150, seed: 30 + i }),
      shDegree,
    }));
    return expectAccurate({ clouds, camera: CAMERA });
  });

  const first = randomSplats({ count: 400, seed: 2 });
  const second = randomSplats({
    count: 300,
    seed: 3,
    shDegree: 1,
    halfExtent: 0.6,
    origin: [0.2, 0.1, -0.3],
  });
  for (const [name, modelMatrix] of Object.entries(TEST_MODELS)) {
    gpuTest(`two clouds that pass through each other, one of them ${name}`, () =>
      expectAccurate({ clouds: [{ set: first, modelMatrix }, { set: second }], camera: CAMERA }),
    );
  }

  for (const opacity of [1, 0.5, 0.01, 0]) {
    gpuTest(`a cloud of opacity ${opacity} before another one`, () => {
      const faded = randomSplats({ count: 400, seed: 2, opacityLogits: [0, 8] });
      return expectAccurate({ clouds: [{ set: faded, opacity }, { set: second }], camera: CAMERA });
    });
  }

  gpuTest('6,400 km from the origin of the world', () => {
    const far = [6.4e6, -3.2e6, 1.7e6] as const;
    const moved = (matrix: ArrayLike<number>, by: readonly number[]): Mat4 => {
      const result = Float64Array.from(matrix);
      for (const axis of [0, 1, 2]) result[12 + axis] += by[axis];
      return result;
    };
    const viewMatrix = translated4(CAMERA.viewMatrix, [-far[0], -far[1], -far[2]]);
    return expectAccurate({
      clouds: [
        { set: first, modelMatrix: moved(TEST_MODELS.moved, far) },
        // The large coordinates are in the file, and there is no model matrix.
        { set: { ...second, origin: far } },
      ],
      camera: cameraFromMatrices(viewMatrix, CAMERA.projectionMatrix),
    });
  });

  gpuTest('a splat larger than the image in front of the others', () => {
    const large = splatsOf([
      { position: [0.4, 0.2, 0.5], logScales: [1, 0, -3], rotation: [0.9, 0.1, 0.3, 0.2], opacityLogit: 0 },
    ]);
    return expectAccurate({ clouds: [...smallScene.clouds, { set: large }], camera: CAMERA });
  });

  gpuTest('equal depths are drawn in the order of storage, clouds in the order given', () => {
    const camera = perspectiveCamera({ position: [0, 0, 2], target: [0, 0, 0], fovYDegrees: 60, aspect: 1 });
    const row = (colorDc: number[], shift: number) =>
      splatsOf(
        Array.from({ length: 30 }, (_, i) => ({
          position: [(i - 15) / 16 + shift, (i % 5) / 8, 0],
          colorDc: colorDc.map((c) => c * (1 + i / 30)),
          opacityLogit: 1,
        })),
      );
    return expectAccurate({
      clouds: [{ set: row([1, -1, 0], 0) }, { set: row([-1, 0, 1], 0.03125) }],
      camera,
    });
  });

  gpuTest('an object alone', { tags: 'deeper' }, async () =>
    expectObjectAccurate(engines, await objectScene(2), isFull ? 256 : 128),
  );
});

describe('a view', () => {
  gpuTest('draws other clouds, cameras and sizes as if it were new', async () => {
    const engine = engines.balanced;
    const view = engine.createView();
    const clouds = [1, 2, 3].map((seed) => engine.add(randomSplats({ count: 200 * seed, seed })));
    const frames: FrameRequest[] = [
      { camera: CAMERA, clouds: [{ cloud: clouds[0] }], ...SIZE },
      { camera: CAMERA, clouds: [{ cloud: clouds[1] }, { cloud: clouds[2] }], ...SIZE },
      { camera: CAMERAS.orthographic, clouds: [{ cloud: clouds[2] }], ...SIZE },
      {
        camera: CAMERA,
        clouds: [{ cloud: clouds[2] }, { cloud: clouds[2], modelMatrix: TEST_MODELS.moved }],
        ...SIZE,
      },
      { camera: CAMERA, clouds: [{ cloud: clouds[0] }], widthPx: 31, heightPx: 7 },
      { camera: CAMERAS.inside, clouds: [{ cloud: clouds[0] }], widthPx: 100, heightPx: 3 },
      { camera: CAMERA, clouds: [{ cloud: clouds[0] }], ...SIZE },
    ];
    for (const frame of frames) {
      const fresh = engine.createView();
      const expected = await draw(fresh, frame);
      fresh.destroy();
      view.render(frame);
      const { data, widthPx, heightPx } = await view.readPixels();
      expect([widthPx, heightPx]).toEqual([frame.widthPx, frame.heightPx]);
      expectSameImage(data, expected);
      expect(Math.max(...data)).toBeGreaterThan(0);
    }
    view.destroy();
    for (const cloud of clouds) cloud.destroy();
  });

  gpuTest(
    'shows a part of a larger image as that image shows it, and is drawn again for another whole',
    async () => {
      const set = randomSplats({ count: 300, logScales: [-3, -0.5], opacityLogits: [-4, -1] });
      const cloud = engines.reference.add(set);
      const view = engines.reference.createView();
      const { viewMatrix, projectionMatrix, near, far } = CAMERA;
      // The right third of the image, 64 of 192 pixels wide.
      const ofPart = Float64Array.from(projectionMatrix);
      for (const column of [0, 4, 8, 12]) ofPart[column] = 3 * ofPart[column] - 2 * ofPart[column + 3];
      const part = cameraFromMatrices(viewMatrix, ofPart, { near, far });
      const camera = { ...part, wholeProjectionMatrix: projectionMatrix };
      const whole = renderReference({ clouds: [{ set }], camera: CAMERA, widthPx: 192, heightPx: 64 }).data;
      const expected = Float64Array.from(
        { length: 4 * 64 * 64 },
        (_, i) => whole[4 * (192 * Math.floor(i / 256) + 128) + (i % 256)],
      );
      const drawn = await draw(view, { camera, clouds: [{ cloud }], ...SIZE });
      expect(compareImages(drawn, expected, SIZE).psnrDb).toBeGreaterThanOrEqual(MIN_PSNR_DB.reference);

      const alone = await draw(view, { camera: part, clouds: [{ cloud }], ...SIZE });
      const referenceAlone = renderReference({ clouds: [{ set }], camera: part, ...SIZE }).data;
      expect(compareImages(alone, referenceAlone, SIZE).psnrDb).toBeGreaterThanOrEqual(MIN_PSNR_DB.reference);
      expect(compareImages(alone, expected, SIZE).psnrDb).toBeLessThan(MIN_PSNR_DB.balanced);
      view.destroy();
      cloud.destroy();
    },
  );

  gpuTest('picks the splat that contributes most to a pixel of the last frame', async () => {
    const engine = engines.balanced;
    const view = engine.createView();
    expect(await view.pick(1, 1)).toBeNull();
    const near = { position: [0, 0, 0.3], opacityLogit: 4, logScales: [-2, -2, -2] };
    const far = { position: [0, 0, -0.3], opacityLogit: 4, logScales: [-1, -1, -1] };
    const cloud = engine.add(splatsOf([far, near]));
    const camera = perspectiveCamera({ position: [0, 0, 3], target: [0, 0, 0], fovYDegrees: 40, aspect: 1 });
    await draw(view, { camera, clouds: [{ cloud }], ...SIZE });
    const found = await view.pick(32, 32);
    expect(found).toMatchObject({ cloudIndex: 0, row: 1 });
    expect(found!.depthView).toBeCloseTo(2.7, 3);
    expect((await view.pick(20, 32))?.row).toBe(0);
    expect(await view.pick(0, 0)).toBeNull();
    expect(await view.pick(64, 5)).toBeNull();
    cloud.destroy();
    const unanswered = view.pick(32, 32);
    view.destroy();
    for (const pick of [unanswered, view.pick(1, 1)]) await expect(pick).rejects.toThrow(DestroyedError);
  });

  const times = isFull ? 100 : 20;
  gpuTest(
    `draws the identical image ${times} times, and so does another engine`,
    { tags: 'deeper' },
    async () => {
      const view = engines.balanced.createView();
      const cloud = engines.balanced.add(randomSplats({ count: 500 }));
      // Four bins.
      const size = { widthPx: 70, heightPx: 66 };
      const frame = { camera: CAMERA, clouds: [{ cloud }], ...size };
      const first = await draw(view, frame);
      for (let i = 1; i < times; i++) expectSameImage(await draw(view, { ...frame, force: true }), first);
      view.destroy();
      cloud.destroy();

      const other = await SplatEngine.create({ device, accuracy: byTiles('balanced') });
      const scene = { clouds: [{ set: randomSplats({ count: 500 }) }], camera: CAMERA };
      expectSameImage(await drawAlone(other, scene, size), first);
      other.destroy();
    },
  );

  gpuTest('submits nothing if nothing has changed, or if there are no pixels', async () => {
    const view = engines.balanced.createView();
    const cloud = engines.balanced.add(randomSplats({ count: 300 }));
    const frame = { camera: CAMERA, clouds: [{ cloud }], ...SIZE };
    const image = await draw(view, frame);
    const { queue } = device;
    const submit = queue.submit;
    let submissions = 0;
    queue.submit = (commands) => {
      submissions++;
      submit.call(queue, commands);
    };
    try {
      // The same request, in other objects.
      expect(view.render({ ...frame, camera: { ...CAMERA }, clouds: [{ cloud }] })).toBe(false);
      for (const [widthPx, heightPx] of [
        [0, 0],
        [0, 64],
        [64, 0],
      ]) {
        expect(view.render({ ...frame, widthPx, heightPx })).toBe(false);
      }
      expect(submissions).toBe(0);
      expect(view.render({ ...frame, camera: CAMERAS.inside })).toBe(true);
      expect(view.render({ ...frame, camera: CAMERAS.inside })).toBe(false);
      expect(view.render({ ...frame, camera: CAMERAS.inside, force: true })).toBe(true);
      expect(submissions).toBe(2);
      expect(view.render(frame)).toBe(true);
    } finally {
      queue.submit = submit;
    }
    expectSameImage((await view.readPixels()).data, image);
    view.destroy();
    cloud.destroy();
  });

  gpuTest('keeps its image when the other rasteriser is chosen for later frames', async () => {
    const engine = await SplatEngine.create({
      device: onOwnAdapter(device, 'other rasteriser'),
      tileBudgetBytes: 0,
    });
    const view = engine.createView();
    const cloud = engine.add(randomSplats({ count: 300 }));
    const frame = { camera: CAMERA, clouds: [{ cloud }], ...SIZE };
    const image = await draw(view, frame);
    expect(view.shape?.rasterizer).toBe('tiles');
    await expect.poll(() => view.rasterizer.rasterizer).toBe('quads');
    expect(view.render({ ...frame })).toBe(false);
    expectSameImage((await view.readPixels()).data, image);
    expect(view.render({ ...frame, camera: CAMERAS.inside })).toBe(true);
    expect(view.shape?.rasterizer).toBe('quads');
    engine.destroy();
  });

  gpuTest('is drawn again when an opacity changes; the default is 1', async () => {
    const view = engines.balanced.createView();
    const cloud = engines.balanced.add(randomSplats({ count: 300 }));
    const frame = (opacity?: number) => ({ camera: CAMERA, clouds: [{ cloud, opacity }], ...SIZE });
    const plain = await draw(view, frame());
    expect(view.render(frame(1))).toBe(false);
    expectSameImage(await draw(view, { ...frame(1), force: true }), plain);
    expect(await draw(view, frame(0.5))).not.toEqual(plain);
    expect((await draw(view, frame(0))).every((value) => value === 0)).toBe(true);
    expectSameImage(await draw(view, frame(1)), plain);
    view.destroy();
    cloud.destroy();
  });

  gpuTest('is drawn again when the degree of a cloud changes; the default is 3', async () => {
    const view = engines.balanced.createView();
    const cloud = engines.balanced.add(randomSplats({ count: 300 }));
    const frame = (shDegree?: ShDegree) => ({ camera: CAMERA, clouds: [{ cloud, shDegree }], ...SIZE });
    const plain = await draw(view, frame());
    expect(view.render(frame(3))).toBe(false);
    expect(await draw(view, frame(1))).not.toEqual(plain);
    expectSameImage(await draw(view, frame(3)), plain);
    view.destroy();
    cloud.destroy();
  });

  gpuTest('of no clouds, of an empty cloud and of clouds out of sight is empty', async () => {
    const engine = engines.balanced;
    const view = engine.createView();
    const cloud = engine.add(randomSplats({ count: 300 }));
    const empty = engine.add(randomSplats({ count: 0 }));
    const away = Float64Array.of(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 500, 1);
    const full = await draw(view, { camera: CAMERA, clouds: [{ cloud }], ...SIZE });
    expect(Math.max(...full)).toBeGreaterThan(0);
    for (const clouds of [[], [{ cloud: empty }], [{ cloud, modelMatrix: away }]]) {
      const image = await draw(view, { camera: CAMERA, clouds, ...SIZE });
      expect(image.every((value) => value === 0)).toBe(true);
    }
    // An empty cloud does not change another one.
    expect(await draw(view, { camera: CAMERA, clouds: [{ cloud: empty }, { cloud }], ...SIZE })).toEqual(
      full,
    );
    for (const thing of [view, cloud, empty]) thing.destroy();
  });

  gpuTest('rejects invalid requests, and says what is wrong', async () => {
    const engine = engines.balanced;
    const view = engine.createView();
    const cloud = engine.add(randomSplats({ count: 10 }), { name: 'garden' });
    const frame = { camera: CAMERA, clouds: [{ cloud }], ...SIZE };
    await expect(view.readPixels()).rejects.toThrow(InvalidArgumentError);
    expect(() => view.render({ ...frame, widthPx: 1.5 })).toThrow(InvalidArgumentError);
    expect(() => view.render({ ...frame, heightPx: -1 })).toThrow(InvalidArgumentError);
    expect(() => view.render({ ...frame, clouds: [{ cloud, modelMatrix: [1, 2, 3] }] })).toThrow(/garden/);
    for (const opacity of [-0.1, 1.1, Number.NaN])
      expect(() => view.render({ ...frame, clouds: [{ cloud, opacity }] })).toThrow(/garden.*0…1/);
    for (const shDegree of [4, 'toString'] as unknown[] as ShDegree[])
      expect(() => view.render({ ...frame, clouds: [{ cloud, shDegree }] })).toThrow(
        `garden: shDegree is ${shDegree}`,
      );
    for (const depths of [
      { far: Number.NaN },
      { far: CAMERA.near },
      { near: Number.NaN },
      { near: -Infinity },
    ])
      expect(() => view.render({ ...frame, camera: { ...CAMERA, ...depths } })).toThrow(
        /near is .* and far is .*; far must be greater/,
      );
    expect(() => view.render({ ...frame, camera: { ...CAMERA, wholeProjectionMatrix: [1] } })).toThrow(
      /^wholeProjectionMatrix is .* it must be 16 finite numbers/,
    );
    expect(view.render({ ...frame, camera: { ...CAMERA, far: Number.POSITIVE_INFINITY } })).toBe(true);
    const elsewhere = await SplatEngine.create({ device: await shareTestDevice() });
    const stranger = elsewhere.add(randomSplats({ count: 10 }), { name: 'stranger' });
    expect(() => view.render({ ...frame, clouds: [{ cloud: stranger }] })).toThrow(
      /stranger is on another GPU/,
    );
    elsewhere.destroy();
    elsewhere.device.destroy();
    const widthPx = device.limits.maxTextureDimension2D + 1;
    await draw(view, frame);
    expect(() => view.render({ ...frame, widthPx })).toThrow(InvalidArgumentError);
    cloud.destroy();
    cloud.destroy();
    expect(() => view.render({ ...frame, force: true })).toThrow(DestroyedError);
    view.destroy();
    view.destroy();
    expect(() => view.render({ ...frame, clouds: [] })).toThrow(DestroyedError);
    await expect(view.readPixels()).rejects.toThrow(DestroyedError);
  });
});

describe('large clouds', () => {
  for (const maxWorkgroupsPerDimension of [undefined, 7]) {
    const rows = maxWorkgroupsPerDimension ? `rows of ${maxWorkgroupsPerDimension} workgroups` : 'one row';
    gpuTest(`in four pages give the identical image of one page: ${rows}`, async () => {
      const set = randomSplats({ count: 256 * 19 + 77 });
      const packed = packCloud(set, { geometryPrecision: 'f32' });
      const engine = await createEngine(
        { device, accuracy: byTiles('reference') },
        { maxWorkgroupsPerDimension },
      );
      const memory = new GpuMemory(device);
      // Five chunks of degree 3 in float32 per page.
      const maxBufferSize = 5 * 256 * 4 * ownHarmonics(packed.harmonics).wordsPerSplat;
      const limits = { maxBufferSize, maxStorageBufferBindingSize: maxBufferSize } as GPUSupportedLimits;
      const paged = SplatCloud.upload(memory, limits, packed, { name: 'paged' });
      expect(paged.pagesFor(engine.accuracy).pages.map(({ splatCount }) => splatCount)).toEqual([
        1280, 1280, 1280, 1101,
      ]);
      const view = engine.createView();
      const inPages = await draw(view, { camera: CAMERA, clouds: [{ cloud: paged }], ...SIZE });
      const expected = await drawScene(engines.reference, { clouds: [{ set }], camera: CAMERA });
      expectSameImage(inPages, expected);
      memory.destroyAll();
      engine.destroy();
    });
  }

  gpuTest('that fit no binding fail before anything is allocated', async () => {
    const limits = limitsWith(device, { maxStorageBufferBindingSize: 10_000, maxBufferSize: 10_000 });
    const small = deviceWith(device, { limits });
    const engine = await SplatEngine.create({ device: small, accuracy: 'reference' });
    const before = engine.memory().totalBytes;
    const add = () => engine.add(randomSplats({ count: 10 }), { name: 'garden' });
    expect(add).toThrow(GpuLimitError);
    expect(add).toThrow(/garden.*46080.*10000/);
    expect(engine.memory().totalBytes).toBe(before);
    engine.destroy();
  });

  gpuTest('whose frame does not fit leave nothing behind, and the view keeps its last image', async () => {
    // Room for the cloud in pages, but not for the records of the visible splats.
    const limits = limitsWith(device, { maxStorageBufferBindingSize: 60_000, maxBufferSize: 60_000 });
    const small = deviceWith(device, { limits });
    const engine = await SplatEngine.create({ device: small, accuracy: 'balanced' });
    const view = engine.createView();
    const few = engine.add(randomSplats({ count: 100 }));
    const many = engine.add(randomSplats({ count: 5000 }));
    const frame = { camera: CAMERA, clouds: [{ cloud: few }], ...SIZE };
    const image = await draw(view, frame);
    const before = engine.memory().totalBytes;
    expect(() => view.render({ ...frame, clouds: [{ cloud: many }] })).toThrow(GpuLimitError);
    expect(engine.memory().totalBytes).toBe(before);
    expectSameImage((await view.readPixels()).data, image);
    engine.destroy();
  });
});

describe('an engine', () => {
  gpuTest('counts its memory, and returns to the start when clouds and views are gone', async () => {
    const engine = await SplatEngine.create({ device });
    expect(engine.memory().totalBytes).toBe(0);
    const view = engine.createView();
    const cloud = engine.add(randomSplats({ count: 1000 }), { name: 'garden' });
    view.render({ camera: CAMERA, clouds: [{ cloud }], ...SIZE });
    await view.whenDrawn();
    const { totalBytes, resources } = engine.memory();
    expect(resources.reduce((sum, { bytes }) => sum + bytes, 0)).toBe(totalBytes);
    expect(resources.find(({ label }) => label === 'garden geometry 0')?.bytes).toBe(32 * 1000);
    expect(resources.find(({ label }) => label === 'splat layer')?.bytes).toBe(8 * 64 * 64);
    // While measurements are still under way.
    view.destroy();
    cloud.destroy();
    await device.queue.onSubmittedWorkDone();
    await expect.poll(() => engine.memory().totalBytes).toBe(0);
    expect(engine.memory()).toMatchObject({ peakBytes: totalBytes, resources: [] });
    engine.destroy();
  });

  gpuTest('counts its memory by cloud and precision, and by view', async () => {
    const engine = await SplatEngine.create({ device, accuracy: byTiles('balanced') });
    const cloud = engine.add(randomSplats({ count: 1000, shDegree: 1 }), { name: 'garden' });
    const plain = engine.add(randomSplats({ count: 256, shDegree: 0 }), { name: 'plain' });
    const [one, other] = [engine.createView(), engine.createEmbeddedView()];
    const idle = engine.memory();
    await draw(one, { camera: CAMERA, clouds: [{ cloud }], ...SIZE });
    await engine.requestPrecision(cloud, { geometryPrecision: 'f32', shPrecision: 'u8' });
    const { totalBytes, peakBytes, scene, frames } = engine.memory();
    expect(scene.clouds).toEqual([
      {
        name: 'garden',
        totalBytes: cloud.bytes,
        geometryBytes: { f32: 64 * 1000 },
        shBytes: { u8: 12 * 1000 },
        chunksBytes: 4 * Chunk.bytes,
      },
      {
        name: 'plain',
        totalBytes: plain.bytes,
        geometryBytes: { packed: 32 * 256 },
        shBytes: {},
        chunksBytes: Chunk.bytes,
      },
    ]);
    expect(scene.totalBytes).toBe(cloud.bytes + plain.bytes);
    expect(frames.views).toHaveLength(2);
    expect(frames.views[1]).toEqual(idle.frames.views[1]);
    const [{ resources }] = frames.views;
    expect(resources.find(({ label }) => label === 'splat layer')?.bytes).toBe(8 * 64 * 64);
    expect(frames.views[0].totalBytes).toBe(resources.reduce((sum, { bytes }) => sum + bytes, 0));
    expect(scene.totalBytes + frames.totalBytes).toBe(totalBytes);
    expect(peakBytes).toBeGreaterThanOrEqual(totalBytes);
    other.destroy();
    plain.destroy();
    await expect.poll(() => engine.memory().frames.totalBytes).toBe(frames.views[0].totalBytes);
    expect(engine.memory().scene.totalBytes).toBe(cloud.bytes);
    engine.destroy();
  });

  gpuTest('counts its work', async () => {
    const engine = await SplatEngine.create({ device, accuracy: 'high' });
    const zero = engine.counters();
    expect(Object.values(zero).every((count) => count === 0)).toBe(true);
    const cloud = engine.add(randomSplats({ count: 1000 }));
    const uploaded = engine.counters();
    expect(uploaded).toEqual({ ...zero, uploads: 1, uploadedBytes: engine.memory().totalBytes });
    expect(uploaded.uploadedBytes).toBe(cloud.bytes);
    const view = engine.createView();
    const frame = { camera: CAMERA, clouds: [{ cloud }], ...SIZE };
    await draw(view, frame);
    await draw(view, frame);
    cloud.destroy();
    cloud.destroy();
    const { pipelinesCompiled, ...counters } = engine.counters();
    const expected = { framesPrepared: 1, framesDrawn: 1, readbacks: 2, cloudsDestroyed: 1 };
    expect({ ...counters, pipelinesCompiled: 0 }).toEqual({ ...uploaded, ...expected });
    // Earlier engines have compiled the pipelines that all share.
    expect(pipelinesCompiled).toBeLessThan(10);
    expect(engine.counters().uploads).toBe(1);
    expect(zero.uploads).toBe(0);
    engine.destroy();
  });

  gpuTest('compiles what most scenes need as soon as there is a view, but not on a CPU', async () => {
    const own = await shareTestDevice();
    const onCpu = await SplatEngine.create({ device: withAdapter(own, { description: 'SwiftShader' }) });
    onCpu.createView();
    expect(onCpu.counters().pipelinesCompiled).toBe(0);
    const engine = await SplatEngine.create({
      device: withAdapter(own, { vendor: 'any', architecture: 'gpu' }),
    });
    const view = engine.createView();
    const { pipelinesCompiled: first } = engine.counters();
    expect(first).toBeGreaterThan(10);
    // The texts of the tiles' shaders come later; all their stages are compiled in one task.
    await expect.poll(() => engine.counters().pipelinesCompiled).toBeGreaterThan(first);
    const ahead = engine.counters().pipelinesCompiled;
    const cloud = engine.add(randomSplats({ count: 300, shDegree: 3 }));
    view.render({ camera: CAMERA, clouds: [{ cloud }], widthPx: 1920, heightPx: 1080 });
    await view.whenDrawn();
    // Sorts by depths in another range have other shaders.
    expect(engine.counters().pipelinesCompiled - ahead).toBeLessThanOrEqual(3);
    engine.destroy();
    onCpu.destroy();
    own.destroy();
  });

  gpuTest('keeps a device that it was given, and destroys its own', async () => {
    const given = await createTestDevice();
    (await SplatEngine.create({ device: given })).destroy();
    let isLost = false;
    void given.lost.then(() => {
      isLost = true;
    });
    const buffer = given.createBuffer({ size: 16, usage: GPUBufferUsage.COPY_DST });
    given.queue.writeBuffer(buffer, 0, new Uint32Array(4));
    await given.queue.onSubmittedWorkDone();
    expect(isLost).toBe(false);
    given.destroy();

    const { gpu } = await createNodeGpu();
    const engine = await SplatEngine.create({ gpu });
    engine.destroy();
    expect((await engine.lost).reason).toBe('destroyed');
  });

  gpuTest('that was destroyed, or whose device was lost, says so', async () => {
    const lostDevice = await createTestDevice();
    for (const end of ['engine', 'device'] as const) {
      const engine = await SplatEngine.create({ device: lostDevice });
      const view = engine.createView();
      if (end === 'engine') {
        engine.destroy();
        engine.destroy();
      } else {
        lostDevice.destroy();
        await engine.lost;
      }
      expect(() => engine.createView()).toThrow(DestroyedError);
      expect(() => engine.add(smallScene.clouds[0].set)).toThrow(DestroyedError);
      expect(() => view.render({ camera: CAMERA, clouds: [], ...SIZE })).toThrow(DestroyedError);
      await expect(engine.load(new Uint8Array())).rejects.toThrow(DestroyedError);
    }
  });

  /**
   * @fault Other WebGPUs: there are no timestamp queries
   * @consequence the image is right; times come from the wall clock
   */
  gpuTest('on a plain device: default limits, no features, wall-clock times and a notice', async () => {
    const plain = await shareTestDevice();
    const engine = await SplatEngine.create({ device: plain, accuracy: 'reference' });
    expect(engine.hasGpuTimestamps).toBe(false);
    expect(engine.accuracy.colorTarget).toBe('rgba16float');
    expect(engine.notices).toEqual([expect.stringContaining('float32-blendable')]);
    const { image, statistics } = await drawMeasured(engine, smallScene);
    expect(statistics.timing).toMatchObject({
      source: 'wall-clock',
      preprocessMs: Number.NaN,
      sortMs: Number.NaN,
      rasterizeMs: Number.NaN,
      passMs: {},
    });
    expect(statistics.timing.totalMs).toBeGreaterThan(0);
    const reference = renderReference({ ...smallScene, ...SIZE });
    expect(compareImages(image, reference.data, SIZE).psnrDb).toBeGreaterThanOrEqual(MIN_PSNR_DB.high);
    engine.destroy();
    plain.destroy();
  });

  /**
   * @fault Other WebGPUs: no `float32-blendable`, as in Firefox
   * @consequence `reference` blends in float16, and `engine.notices` says so
   */
  gpuTest('blends in float32 if the device can', ({ skip }) => {
    if (!canBlendFloat32) skip('this adapter has no float32-blendable');
    expect(engines.reference.accuracy.colorTarget).toBe('rgba32float');
    expect(engines.reference.notices).toEqual([]);
  });

  gpuTest('counts the splats that it draws', async () => {
    for (const camera of [CAMERA, CAMERAS.inside, CAMERAS.telephoto]) {
      const set = randomSplats({ count: 2000, halfExtent: 3 });
      const { statistics } = await drawMeasured(engines.reference, { clouds: [{ set }], camera });
      const { visibleSplats } = renderReference({ clouds: [{ set }], camera, ...SIZE });
      expect(statistics.loadedSplats).toBe(2000);
      // At most two lie so close to an edge that rounding decides.
      expect(Math.abs(statistics.visibleSplats - visibleSplats)).toBeLessThanOrEqual(2);
      expect(statistics.candidateSplats).toBeGreaterThanOrEqual(statistics.visibleSplats);
      expect(statistics.candidateSplats).toBeLessThanOrEqual(2000);
    }
  });

  gpuTest('times its stages if the device has timestamps', async ({ skip }) => {
    if (!device.features.has('timestamp-query')) skip('this adapter has no timestamp-query');
    const { statistics } = await drawMeasured(engines.balanced, smallScene);
    const { source, preprocessMs, sortMs, rasterizeMs, totalMs, passMs } = statistics.timing;
    expect(source).toBe('gpu-timestamps');
    expect(passMs).toMatchObject({ preprocess: preprocessMs, sort: sortMs });
    // Quads have one pass for the two of tiles.
    expect(Object.keys(passMs)).toContain(statistics.rasterizer === 'tiles' ? 'tiles' : 'rasterize');
    expect('tile-lists' in passMs).toBe(statistics.rasterizer === 'tiles');
    for (const ms of Object.values(passMs)) expect(ms).toBeLessThanOrEqual(totalMs);
    for (const ms of [preprocessMs, sortMs, rasterizeMs]) expect(ms).toBeGreaterThanOrEqual(0);
    expect(totalMs).toBeGreaterThan(0);
    expect(preprocessMs + sortMs + rasterizeMs).toBeLessThanOrEqual(totalMs * 1.001 + 1e-6);
  });

  gpuTest(
    'draws each frame with its requested accuracy, else with the engine’s, which may change',
    async () => {
      const engine = await SplatEngine.create({ device, accuracy: byTiles('balanced') });
      const cloud = engine.add(randomSplats({ count: 500 }));
      const view = engine.createView();
      const frame = { camera: CAMERA, clouds: [{ cloud }], ...SIZE };
      const own = await draw(view, frame);
      const coarse = {
        rasterizer: 'tiles',
        sortKeyBits: 16,
        alphaCutoff: 0.05,
        colorTarget: 'rgba8unorm',
      } as const;
      const asked = await draw(view, { ...frame, accuracy: coarse });
      expect(asked).not.toEqual(own);
      expect(asked.every((value) => Math.abs(value * 255 - Math.round(value * 255)) < 1e-4)).toBe(true);
      // Equal settings in another object give the same frame.
      expect(view.render({ ...frame, accuracy: { ...coarse } })).toBe(false);
      expectSameImage(await draw(view, frame), own);

      expect(() => engine.setAccuracy({ ...coarse, sortKeyBits: 7 as never })).toThrow(InvalidArgumentError);
      expect(engine.accuracy.sortKeyBits).toBe(32);
      expect(view.render(frame)).toBe(false);
      engine.setAccuracy(coarse);
      expect(engine.accuracy).toMatchObject(coarse);
      expectSameImage(await draw(view, frame), asked);
      expectSameImage(await draw(view, { ...frame, accuracy: byTiles('balanced') }), own);
      expect((await view.pick(32, 32))?.weight).toBeGreaterThan(0);
      engine.destroy();
    },
  );

  gpuTest('loads the precision that is asked for, whatever its accuracy is and becomes', async () => {
    const file = new Blob([encodePly(randomSplats({ count: 20, shDegree: 1, seed: 5 })) as BlobPart]);
    const finest = { geometryPrecision: 'f32', shPrecision: 'f32' } as const;
    // Tests of rows that are ingested leave their shaders with plain devices.
    const plain = await shareTestDevice();
    // Packed on the CPU, and on the GPU.
    for (const ingestMinRows of [undefined, 1]) {
      const engine = await createEngine({ device: plain }, { ingestMinRows });
      const loading = engine.load(file, { precision: finest });
      await engine.setAccuracy('fast');
      const cloud = await loading;
      await cloud.ownLease.met;
      expect(cloud.precisions).toEqual({ geometry: ['f32'], sh: ['f32'] });
      engine.destroy();
    }
    plain.destroy();
  });

  gpuTest('draws clouds that were packed for another accuracy from the planes that they hold', async () => {
    const [set] = smallScene.clouds.map((cloud) => cloud.set);
    const packed = packCloud(set, { geometryPrecision: 'f32' });
    const view = engines.balanced.createView();
    const cloud = engines.balanced.addPacked(packed);
    expect(cloud.precisions).toEqual({ geometry: ['f32'], sh: ['f32'] });
    const image = await draw(view, { camera: CAMERA, clouds: [{ cloud }], ...SIZE });
    const reference = renderReference({ ...smallScene, ...SIZE });
    const { psnrDb } = compareImages(image, reference.data, SIZE);
    expect(psnrDb).toBeGreaterThanOrEqual(MIN_PSNR_DB.high);
    view.destroy();
    cloud.destroy();
  });

  gpuTest('rejects unknown settings', async () => {
    const accuracy = 'perfect' as unknown as Accuracy;
    await expect(SplatEngine.create({ device, accuracy })).rejects.toThrow(InvalidArgumentError);
  });
});

/** Bit for bit; a deep comparison of so many numbers takes longer than drawing them. */
function expectSameImage(actual: Float32Array, expected: Float32Array): void {
  expect(actual.length).toBe(expected.length);
  if (Buffer.compare(Buffer.from(actual.buffer), Buffer.from(expected.buffer)) === 0) return;
  const at = expected.findIndex((value, i) => !Object.is(value, actual[i]));
  expect.fail(`value ${at} of ${expected.length}: got ${actual[at]}, expected ${expected[at]}`);
}

/** Draws until a frame has been measured; the first, which compiles shaders, may not be. */
async function drawMeasured(
  engine: SplatEngine,
  { clouds, camera }: Scene,
): Promise<{ image: Float32Array; statistics: FrameStatistics }> {
  const view = engine.createView();
  const instances = clouds.map(({ set, modelMatrix }) => ({ cloud: engine.add(set), modelMatrix }));
  const frame = { camera, clouds: instances, ...SIZE };
  await draw(view, frame);
  const image = await draw(view, { ...frame, force: true });
  await expect.poll(() => view.statistics).not.toBeNull();
  const statistics = view.statistics!;
  view.destroy();
  for (const { cloud } of instances) cloud.destroy();
  return { image, statistics };
}
