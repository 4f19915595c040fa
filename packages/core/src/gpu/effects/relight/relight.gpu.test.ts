// Proves: splats are lit as in float64, by every kind of light and in every place.
import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { SplatEngine } from '../../../create-engine.ts';
import { compareImages, renderReference } from '../../../reference/index.ts';
import { expectAsReference } from '../../../testing/expect-as-reference.ts';
import { randomSplats, splatsOf } from '../../../testing/random-splats.ts';
import { TEST_MODELS, testCameras } from '../../../testing/test-cameras.ts';
import { testGpu } from '../../../testing/test-gpu.ts';
import { type RelightLight, type RelightOptions, relight } from './relight.ts';

const isFull = process.env.WEBSPLATTER_FULL === '1';

const SIZE = { widthPx: 48, heightPx: 48 };
const CAMERAS = testCameras(1);
const SET = randomSplats({ count: 600, seed: 83, shDegree: 1, logScales: [-5, -2.5], colorDc: [-3, 3] });

const LIGHTS: Readonly<Record<string, RelightLight>> = {
  'the sun': { kind: 'directional', direction: [1, -3, -2], irradiance: [3, 2.5, 2] },
  'a point light': { kind: 'point', position: [0.5, 0.7, 0.2], irradiance: [1, 2, 3], distance: 2.5 },
  'a point light of another decay': {
    kind: 'point',
    position: [-0.5, 0.9, 0.4],
    irradiance: [1, 2, 3],
    decay: 0.5,
  },
  'a spot light': {
    kind: 'spot',
    position: [0.5, 2, 1],
    direction: [-0.2, -2, -1],
    irradiance: [20, 18, 16],
    cone: { angle: 0.4, penumbra: 0.5, decay: 1.5, distance: 9 },
  },
  'sky and ground': { kind: 'hemisphere', up: [0.1, 2, 0], irradiance: [1, 2, 3], ground: [2, 1, 0.2] },
};

const gpu = testGpu();

describe('relight', () => {
  for (const [name, light] of Object.entries(LIGHTS))
    gpuTest(`by ${name}, on clouds in any place`, { tags: 'deeper' }, async () => {
      const effects = [relight({ lights: [light], ambient: [0.4, 0.5, 0.6] })];
      const clouds = Object.values(TEST_MODELS).map((modelMatrix) => ({ set: SET, modelMatrix, effects }));
      // One shader lights by all kinds: in the first tier, one light shows it in an orthographic view.
      const isInBoth = isFull || name === 'the sun';
      for (const camera of isInBoth ? [CAMERAS.perspective, CAMERAS.orthographic] : [CAMERAS.perspective]) {
        const counts = await expectAsReference(gpu.device, { clouds, camera, ...SIZE }, 2e-4);
        expect(counts[0]).toBeGreaterThan(100);
      }
    });

  gpuTest('round, long, flat and huge splats are as in float64', async () => {
    const set = splatsOf([
      { logScales: [-1, -1, -1] },
      { logScales: [-3, -3, -1] },
      { logScales: [-1, -9, -1], rotation: [0.8, 0.3, -0.4, 0.33] },
      { logScales: [-1, -1.2, -100], rotation: [0.3, 0.3, 0.9, 0.1] },
      { logScales: [8, 7, 6], rotation: [0.8, 0.3, -0.4, 0.33] },
    ]);
    const effects = [relight({ lights: Object.values(LIGHTS), strength: 0.7 })];
    const clouds = [{ set, effects }];
    const [count] = await expectAsReference(
      gpu.device,
      { clouds, camera: CAMERAS.perspective, ...SIZE },
      2e-4,
    );
    expect(count).toBeGreaterThan(3);
  });

  gpuTest('pictures of all lights, a cloud that is flattened, and frames that change nothing', async () => {
    const engine = await SplatEngine.create({ device: gpu.device, accuracy: 'high' });
    const cloud = engine.add(SET);
    const view = engine.createView();
    const flattened = [1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0.1, 0, 1];
    const camera = CAMERAS.perspective;
    const picture = async (options: RelightOptions | null, modelMatrix = TEST_MODELS.sheared) => {
      const effects = options ? [relight(options)] : [];
      view.render({ camera, clouds: [{ cloud, modelMatrix, effects }], ...SIZE });
      return (await view.readPixels()).data;
    };
    const psnr = async (options: RelightOptions, modelMatrix = TEST_MODELS.sheared) => {
      const clouds = [{ set: SET, modelMatrix, effects: [relight(options)] }];
      const { data } = renderReference({ clouds, camera, ...SIZE });
      return compareImages(await picture(options, modelMatrix), data, SIZE).psnrDb;
    };
    const all = { lights: Object.values(LIGHTS), ambient: [0.2, 0.2, 0.2] } as const;
    expect(await psnr(all)).toBeGreaterThan(60);
    expect(await psnr({ ...all, strength: 0.5 })).toBeGreaterThan(60);
    expect(await psnr(all, Float64Array.from(flattened))).toBeGreaterThan(60);
    const plain = await picture(null);
    expect(await picture({ ...all, strength: 0 })).toEqual(plain);
    const white = await picture({ ambient: [Math.PI, Math.PI, Math.PI] });
    expect(compareImages(white, plain, SIZE).psnrDb).toBeGreaterThan(70);
    expect(compareImages(await picture(all), plain, SIZE).psnrDb).toBeLessThan(30);
    const { framesDrawn } = engine.counters();
    await picture(structuredClone(all));
    expect(engine.counters().framesDrawn).toBe(framesDrawn);
    await picture({ ...all, lights: all.lights.slice(1) });
    expect(engine.counters().framesDrawn).toBe(framesDrawn + 1);
    const [entry] = view.effects().filter(({ name }) => name === 'relight');
    expect(entry).toMatchObject({
      isOn: true,
      reason: 'it is lit by 4 lights and ambient light',
      stages: ['project'],
    });
    engine.destroy();
  });

  gpuTest('instances', async () => {
    const engine = await SplatEngine.create({ device: gpu.device, accuracy: 'high' });
    const cloud = engine.add(SET);
    const view = engine.createView();
    const place = (x: number) => [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, 0, 0, 1];
    const effects = [relight({ lights: Object.values(LIGHTS) })];
    const picture = async (clouds: Parameters<typeof view.render>[0]['clouds']) => {
      view.render({ camera: CAMERAS.perspective, clouds, ...SIZE });
      return (await view.readPixels()).data;
    };
    const modelMatrices = [...place(0.4), ...place(-0.5)];
    const together = await picture([{ cloud, effects, instances: { modelMatrices } }]);
    const apart = await picture([
      { cloud, effects, modelMatrix: place(0.4) },
      { cloud, effects, modelMatrix: place(-0.5) },
    ]);
    expect(together).toEqual(apart);
    engine.destroy();
  });
});
