// Proves: each effect and random sets of effects are drawn as in float64.
import { gpuTest, shareTestDevice } from '@websplatter/node/gpu-test';
import { beforeAll, describe, expect } from 'vitest';
import type { SplatCloud } from '../../clouds/splat-cloud.ts';
import { SplatEngine } from '../../create-engine.ts';
import type { Camera } from '../../data/camera/camera.ts';
import { gradeSplats } from '../../data/editing/grade-splats.ts';
import type { SplatSet } from '../../data/splats/splat-set.ts';
import { compareImages, renderReference } from '../../reference/index.ts';
import { EFFECT_EXAMPLES } from '../../testing/effect-examples.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { testCameras } from '../../testing/test-cameras.ts';
import type { SplatView } from '../../views/splat-view.ts';
import { defineEffect } from './define-effect.ts';
import type { EffectUse } from './effect.ts';
import { grade } from './grade/grade.ts';

const isFull = process.env.WEBSPLATTER_FULL === '1';

const SIZE = { widthPx: 48, heightPx: 48 };
const CAMERAS = testCameras(1);
/** Some of the colours are below 0 or above 1. */
const SET = randomSplats({
  count: 1200,
  seed: 60,
  shDegree: 1,
  logScales: [-4.5, -2],
  colorDc: [-3, 3],
});
/** Moved, turned, stretched and sheared. */
const MODEL = [0.9, 0.3, 0, 0, -0.3, 0.8, 0.1, 0, 0.2, 0, 1.1, 0, 0.1, -0.1, 0.2, 1];

let device: GPUDevice;
let engine: SplatEngine;
let view: SplatView;
let cloud: SplatCloud;
beforeAll(async () => {
  device = await shareTestDevice();
  engine = await SplatEngine.create({ device, accuracy: 'high' });
  view = engine.createView();
  cloud = engine.add(SET);
});

async function draw(
  effects: readonly EffectUse[],
  camera: Camera,
  drawn: SplatCloud = cloud,
): Promise<Float32Array> {
  view.render({ camera, clouds: [{ cloud: drawn, modelMatrix: MODEL, effects }], ...SIZE });
  return (await view.readPixels()).data;
}

async function psnrAgainstReference(
  effects: readonly EffectUse[],
  camera = CAMERAS.perspective,
): Promise<number> {
  const data = await draw(effects, camera);
  const reference = renderReference({ clouds: [{ set: SET, modelMatrix: MODEL, effects }], camera, ...SIZE });
  return compareImages(data, reference.data, SIZE).psnrDb;
}

describe('an effect', () => {
  for (const [i, use] of EFFECT_EXAMPLES.entries()) {
    // In the first tier, effects that ask for the camera have orthographic tests of their own.
    const cameras =
      isFull || i === 0 ? (['perspective', 'orthographic'] as const) : (['perspective'] as const);
    const name = `${use.effect.name}: as in float64, in ${cameras.join(' and ')} views`;
    gpuTest(name, { tags: 'deeper' }, async () => {
      for (const camera of cameras.map((each) => CAMERAS[each])) {
        expect(await psnrAgainstReference([use], camera)).toBeGreaterThan(60);
        // And it is visible.
        const without = await draw([], camera);
        expect(compareImages(await draw([use], camera), without, SIZE).psnrDb).toBeLessThan(45);
      }
    });
  }
});

/** Brightens all colours by 0.3. */
const lifted = defineEffect({
  name: 'test-lift',
  label: 'Lift',
  about: 'Brightens all colours.',
  hooks: { color: 'liftColor' },
  wgsl: `import package::lib::packing::Splat;
fn liftColor(color: vec3f, splat: Splat, splatIndex: u32, centerView: vec3f) -> vec3f { return color + 0.3; }`,
  calledFor: () => 'a test brightens colours',
});

describe('a colour below 0 comes to an effect as it is', () => {
  /** Pictures of an effect, and of splats that have its colours. */
  const psnrOf = async (use: EffectUse, set: SplatSet) => {
    const written = engine.add(set);
    try {
      const [byEffect, bySplats] = [
        await draw([use], CAMERAS.perspective),
        await draw([], CAMERAS.perspective, written),
      ];
      return compareImages(byEffect, bySplats, SIZE).psnrDb;
    } finally {
      written.destroy();
    }
  };

  for (const options of [
    { saturation: 0 },
    { saturation: 2.5 },
    { exposure: -2, saturation: 2.5, temperature: -0.7 },
    { exposure: 1 },
  ])
    gpuTest(`grade ${JSON.stringify(options)}, as gradeSplats writes it`, async () => {
      expect(await psnrOf(grade(options), gradeSplats(SET, options) as SplatSet)).toBeGreaterThan(60);
    });

  gpuTest('an effect of a caller that adds light', async () => {
    const colorDc = SET.colorDc.map((value) => value + 0.3 / Math.sqrt(0.25 / Math.PI));
    expect(await psnrOf(lifted(), { ...SET, colorDc })).toBeGreaterThan(60);
  });
});

describe('effects together', () => {
  const sets = isFull ? 10 : 2;
  gpuTest(`${sets} random sets`, { tags: 'deeper' }, async () => {
    const random = seededRandom(7);
    for (let i = 0; i < sets; i++) {
      const some = EFFECT_EXAMPLES.filter(() => random() < 0.5);
      const names = some.map(({ effect }) => effect.name).join(', ');
      expect(await psnrAgainstReference(some, CAMERAS.inside), names).toBeGreaterThan(45);
    }
  });
});
