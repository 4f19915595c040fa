// Proves: tiles draw each effect and setting as float64 does, without help by quads.
import { gpuTest, shareBlendingDevice } from '@websplatter/node/gpu-test';
import { beforeAll, describe, expect } from 'vitest';
import { createEngine, type SplatEngine } from '../create-engine.ts';
import type { AccuracySettings, ColorTarget, RecordPrecision } from '../data/accuracy/accuracy.ts';
import { type Camera, perspectiveCamera } from '../data/camera/camera.ts';
import type { ShDegree } from '../data/splats/splat-set.ts';
import { antialias, tint } from '../gpu/effects/index.ts';
import { type ReferenceFrame, renderReference } from '../reference/render.ts';
import { compareImages } from '../stages/measure/measure.reference.ts';
import { EFFECT_EXAMPLES } from '../testing/effect-examples.ts';
import { randomSplats, splatsOf } from '../testing/random-splats.ts';
import { TEST_MODELS, testCameras } from '../testing/test-cameras.ts';
import type { SplatView } from '../views/splat-view.ts';
import type { FrameRequest } from './plan/frame-request.ts';

const isFull = process.env.WEBSPLATTER_FULL === '1';

/** Six bins, four of which are cut off by the edges of the image. */
const SIZE = { widthPx: 130, heightPx: 66 };
const CAMERAS = testCameras(SIZE.widthPx / SIZE.heightPx);
const SET = randomSplats({ count: 800, seed: 80, logScales: [-4.5, -1.5] });

let device: GPUDevice;
let engine: SplatEngine;
let view: SplatView;
beforeAll(async () => {
  device = await shareBlendingDevice();
  // Quads draw nothing: tiles drew everything that these images show.
  const mutation = {
    file: 'stages/rasterize',
    find: 'fragment.color = vec4f(color.rgb * alpha, alpha);',
    replace: 'fragment.color = 0.0 * vec4f(color.rgb * alpha, alpha);',
  };
  const accuracy = { preset: 'reference', rasterizer: 'tiles' } as const;
  engine = await createEngine({ device, accuracy }, { mutation });
  view = engine.createView();
});

type Scene = Pick<ReferenceFrame, 'clouds'> & { readonly camera?: Camera };
type Settings = Partial<AccuracySettings>;

async function draw({ clouds, camera = CAMERAS.perspective }: Scene, settings: Settings = {}, size = SIZE) {
  const instances = clouds.map(({ set, ...placement }) => ({ ...placement, cloud: engine.add(set) }));
  try {
    const accuracy = { preset: 'reference', rasterizer: 'tiles', ...settings } as const;
    view.render({ camera, clouds: instances, ...size, accuracy, force: true });
    return (await view.readPixels()).data;
  } finally {
    for (const { cloud } of instances) cloud.destroy();
  }
}

async function psnrAgainstReference(scene: Scene, settings: Settings = {}, size = SIZE): Promise<number> {
  const data = await draw(scene, settings, size);
  const reference = renderReference({ camera: CAMERAS.perspective, ...scene, ...size, settings });
  expect(reference.visibleSplats).toBeGreaterThan(0);
  return compareImages(data, reference.data, size).psnrDb;
}

/** Bit for bit; a deep comparison of so many numbers takes longer than drawing them. */
function isSameImage(a: Float32Array, b: Float32Array): boolean {
  return Buffer.compare(Buffer.from(a.buffer), Buffer.from(b.buffer)) === 0;
}

const ONE = { clouds: [{ set: SET }] };

describe('tiles draw as float64 does', () => {
  for (const [name, camera] of Object.entries(CAMERAS)) {
    gpuTest(`${name} camera`, async () => {
      expect(await psnrAgainstReference({ ...ONE, camera })).toBeGreaterThan(95);
    });
  }

  // Effects act before tiles do: tests of effects show the others in the short run.
  for (const use of isFull ? EFFECT_EXAMPLES : EFFECT_EXAMPLES.slice(0, 1)) {
    gpuTest(`with ${use.effect.name}`, { tags: 'deeper' }, async () => {
      const scene = { clouds: [{ set: SET, modelMatrix: TEST_MODELS.sheared, effects: [use] }] };
      for (const camera of [CAMERAS.perspective, CAMERAS.orthographic]) {
        expect(await psnrAgainstReference({ ...scene, camera })).toBeGreaterThan(90);
      }
    });
  }

  gpuTest('several clouds that pass through each other', async () => {
    const clouds = Object.values(TEST_MODELS).map((modelMatrix, i) => ({
      set: randomSplats({ count: 300, seed: 90 + i, shDegree: (i % 4) as 0 | 1 | 2 | 3 }),
      modelMatrix,
      opacity: 1 - i / 8,
    }));
    expect(await psnrAgainstReference({ clouds })).toBeGreaterThan(90);
  });

  gpuTest('huge splats and needles', async () => {
    for (const logScales of [
      [-40, 40],
      [-9, 3],
      [-18, 0],
    ] as const) {
      const set = randomSplats({ count: 200, seed: 81, logScales });
      for (const camera of [CAMERAS.perspective, CAMERAS.inside, CAMERAS.orthographic]) {
        expect(await psnrAgainstReference({ clouds: [{ set }], camera })).toBeGreaterThan(90);
      }
    }
  });

  gpuTest('splats of equal depth, in storage order', async () => {
    const camera = perspectiveCamera({
      position: [0, 0, 2],
      target: [0, 0, 0],
      fovYDegrees: 60,
      aspect: SIZE.widthPx / SIZE.heightPx,
    });
    const sheet = (seed: number) => {
      const set = randomSplats({ count: 600, seed, logScales: [-3, -1] });
      return { set: { ...set, positions: set.positions.map((value, i) => (i % 3 === 2 ? 0 : value)) } };
    };
    expect(await psnrAgainstReference({ clouds: [sheet(82), sheet(83)], camera })).toBeGreaterThan(95);
  });

  gpuTest('5,000 layers on one pixel, and 2,000 splats over everything', async () => {
    const layers = (count: number, logScale: number, opacityLogit: number) =>
      splatsOf(
        Array.from({ length: count }, (_, i) => ({
          position: [0.02, 0.01, (i - count / 2) / count],
          logScales: [logScale, logScale, logScale],
          opacityLogit,
          colorDc: [Math.sin(i), Math.cos(i), i / count],
        })),
      );
    const camera = perspectiveCamera({ position: [0, 0, 3], target: [0, 0, 0], fovYDegrees: 50, aspect: 1 });
    // The reference draws thousands of layers on each pixel.
    const size = { widthPx: 24, heightPx: 24 };
    for (const set of [layers(5000, -9, -4.5), layers(5000, -9, 3), layers(2000, 4, -4.5)]) {
      expect(await psnrAgainstReference({ clouds: [{ set }], camera }, {}, size)).toBeGreaterThan(90);
    }
  });
});

describe('tiles keep every setting', () => {
  /** Tiles round each pixel once, to the target: 58.9 dB in 8 bits, for any number of layers. */
  const MIN_PSNR_DB = {
    f32: { rgba32float: 95, rgba16float: 75, rgba8unorm: 58.5 },
    f16: { rgba32float: 70, rgba16float: 70, rgba8unorm: 58 },
    paper: { rgba32float: 45, rgba16float: 45, rgba8unorm: 45 },
  } as const satisfies Record<RecordPrecision, Record<ColorTarget, number>>;
  /** The paper's records clamp colours at 1: these stay below. */
  const MUTED = { ...SET, harmonics: splatsOf([]).harmonics, colorDc: SET.colorDc.map((value) => value / 2) };
  for (const recordPrecision of ['f32', 'f16', 'paper'] as const)
    for (const colorTarget of ['rgba32float', 'rgba16float', 'rgba8unorm'] as const) {
      gpuTest(`records in ${recordPrecision}, blending in ${colorTarget}`, async () => {
        const settings = { recordPrecision, colorTarget };
        const psnrDb = await psnrAgainstReference({ clouds: [{ set: MUTED }] }, settings);
        expect(psnrDb).toBeGreaterThan(MIN_PSNR_DB[recordPrecision][colorTarget]);
      });
    }

  gpuTest('extent and culling: the same image', { tags: 'deeper' }, async () => {
    const large = randomSplats({ count: 500, seed: 84, logScales: [-4, 1], opacityLogits: [-5, 2] });
    const cameras = [CAMERAS.inside, CAMERAS.orthographic];
    for (const camera of isFull ? [CAMERAS.perspective, ...cameras] : cameras)
      for (const set of [SET, large]) {
        const scene = { clouds: [{ set }], camera };
        const plain = await draw(scene);
        for (const settings of [{ extent: 'fixed' }, { culling: 'frustum' }] as const) {
          // A tile may end some splats earlier or later, where less than 2⁻¹⁶ of light passes.
          const { maxError } = compareImages(await draw(scene, settings), plain, SIZE);
          expect(maxError, JSON.stringify(settings)).toBeLessThan(2 ** -15);
        }
      }
  });

  gpuTest('sort keys of fewer bits: the order of the shortened keys', async () => {
    // A deep scene, so that few bits lose much.
    const set = randomSplats({ count: 1500, seed: 85, halfExtent: 30, logScales: [-2, 0] });
    for (const sortKeyBits of [24, 16] as const) {
      const db = await psnrAgainstReference({ clouds: [{ set }], camera: CAMERAS.inside }, { sortKeyBits });
      // Splats swap if their float32 depths cross a step, which the reference does not model.
      expect(db).toBeGreaterThan(55);
    }
  });

  gpuTest('a scaled resolution, another cutoff, fewer bands of harmonics', async () => {
    for (const { shDegree, ...settings } of [
      { resolutionScale: 0.25 },
      { resolutionScale: 0.77 },
      { alphaCutoff: 0.03 },
      { shDegree: 1 },
    ] as (Settings & { readonly shDegree?: ShDegree })[])
      for (const camera of [CAMERAS.orthographic, CAMERAS['off-centre']]) {
        const clouds = [{ set: SET, shDegree }];
        expect(await psnrAgainstReference({ clouds, camera }, settings)).toBeGreaterThan(90);
      }
  });
});

describe('a view with tiles', () => {
  gpuTest('is empty without clouds, without splats and where none is in sight', async () => {
    const away = Float64Array.of(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 500, 1);
    const empty = randomSplats({ count: 0 });
    for (const clouds of [
      [],
      [{ set: empty }],
      [{ set: SET, modelMatrix: away }],
      [{ set: SET, opacity: 0 }],
    ]) {
      // The last frame's layer must not show.
      expect(Math.max(...(await draw(ONE)))).toBeGreaterThan(0);
      expect((await draw({ clouds })).every((value) => value === 0)).toBe(true);
    }
    const both = { clouds: [{ set: empty }, { set: SET }] };
    expect(isSameImage(await draw(both), await draw(ONE))).toBe(true);
  });

  gpuTest('has any size from no pixel to many bins', async () => {
    const cloud = engine.add(SET);
    const own = engine.createView();
    expect(own.render({ camera: CAMERAS.inside, clouds: [{ cloud }], widthPx: 0, heightPx: 9 })).toBe(false);
    for (const [widthPx, heightPx] of [
      [1, 1],
      [64, 64],
      [65, 63],
      [3, 300],
      [513, 2],
      [1, 1],
    ]) {
      const camera = testCameras(widthPx / heightPx).inside;
      own.render({ camera, clouds: [{ cloud }], widthPx, heightPx });
      const { data } = await own.readPixels();
      const reference = renderReference({ ...ONE, camera, widthPx, heightPx });
      expect(compareImages(data, reference.data, { widthPx, heightPx }).psnrDb).toBeGreaterThan(90);
    }
    own.destroy();
    cloud.destroy();
  });

  gpuTest('picks the splat that contributes most to a pixel', async () => {
    const near = { position: [0, 0, 0.3], opacityLogit: 4, logScales: [-2, -2, -2] };
    const far = { position: [0, 0, -0.3], opacityLogit: 4, logScales: [-1, -1, -1] };
    const cloud = engine.add(splatsOf([far, near]));
    const camera = perspectiveCamera({ position: [0, 0, 3], target: [0, 0, 0], fovYDegrees: 40, aspect: 1 });
    view.render({ camera, clouds: [{ cloud }], widthPx: 70, heightPx: 70 });
    const found = await view.pick(35, 35);
    expect(found).toMatchObject({ cloudIndex: 0, row: 1 });
    expect(found!.depthView).toBeCloseTo(2.7, 3);
    const { data } = await view.readPixels();
    expect(found!.totalOpacity).toBeCloseTo(data[4 * (35 * 70 + 35) + 3], 5);
    expect((await view.pick(20, 35))?.row).toBe(0);
    expect(await view.pick(0, 0)).toBeNull();
    cloud.destroy();
  });

  gpuTest(
    'draws again as a new view would where only colours, or only the camera’s roll, have changed',
    async () => {
      const cloud = engine.add(SET);
      const own = engine.createView();
      const rolled = (angle: number): Camera =>
        perspectiveCamera({
          position: [0.3, -0.2, 3],
          target: [0.3, -0.2, 0],
          up: [Math.sin(angle), Math.cos(angle), 0],
          fovYDegrees: 50,
          aspect: SIZE.widthPx / SIZE.heightPx,
        });
      const frame = (angle: number, red: number): FrameRequest => ({
        camera: rolled(angle),
        clouds: [{ cloud, effects: [tint([red, 0.5, 0.5])] }],
        ...SIZE,
      });
      const expectAsNew = async (request: FrameRequest) => {
        own.render(request);
        const { data } = await own.readPixels();
        const fresh = engine.createView();
        fresh.render(request);
        expect(isSameImage(data, (await fresh.readPixels()).data)).toBe(true);
        fresh.destroy();
      };
      for (const [angle, red] of [
        [0, 0.2],
        [0, 0.9],
        [1, 0.9],
        [1, 0.3],
        [2, 0.3],
      ])
        await expectAsNew(frame(angle, red));
      own.destroy();
      cloud.destroy();
    },
  );

  gpuTest('follows an opacity that changes while the camera stands still', async () => {
    const cloud = engine.add(SET);
    const own = engine.createView();
    for (const opacity of [0.3, 1, 0.02]) {
      const effects = [antialias()];
      own.render({ camera: CAMERAS.perspective, clouds: [{ cloud, opacity, effects }], ...SIZE });
      const { data } = await own.readPixels();
      expect(isSameImage(data, await draw({ clouds: [{ set: SET, opacity, effects }] }))).toBe(true);
    }
    own.destroy();
    cloud.destroy();
  });
});
