import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect, test } from 'vitest';
import { SplatEngine } from '../../../create-engine.ts';
import { ANTIALIAS_DILATION_PX2, DILATION_PX2 } from '../../../data/accuracy/accuracy.ts';
import { InvalidArgumentError } from '../../../data/errors.ts';
import type { CloudInstance } from '../../../frame/plan/frame-request.ts';
import { findNonFinite } from '../../../inspect/find-non-finite.ts';
import { InspectedFrame } from '../../../inspect/inspected-frame.ts';
import { readRecords } from '../../../inspect/read-records.ts';
import type { EffectReference } from '../../../reference/effects/effect-reference.ts';
import { compareImages, renderReference } from '../../../reference/index.ts';
import { cullSplat } from '../../../stages/cull/cull.reference.ts';
import { expectAsReference } from '../../../testing/expect-as-reference.ts';
import { randomSplats, type SplatValues, splatsOf } from '../../../testing/random-splats.ts';
import { testCameras } from '../../../testing/test-cameras.ts';
import { testGpu } from '../../../testing/test-gpu.ts';
import { defineEffect } from '../define-effect.ts';
import { antialias } from './antialias.ts';

const SIZE = { widthPx: 48, heightPx: 48 };
const CAMERAS = testCameras(1);
/** No axis of the splat is parallel to one of the screen's. */
const TURNED = [0.8, 0.3, -0.4, 0.33];

const DRAWN: Readonly<Record<string, SplatValues>> = {
  'as large as the image': { logScales: [0, 0, 0] },
  'of about a pixel': { logScales: [-3.5, -3.5, -3.5] },
  'a speck': { logScales: [-5, -5, -5] },
  'a needle': { logScales: [-1, -5, -5], rotation: TURNED },
  'a needle a million times as long as wide': { logScales: [10, -4, -4], rotation: TURNED },
  flat: { logScales: [-2, -2, -100], rotation: TURNED },
  'so large that float32 could not square it': { logScales: [40, 40, 40] },
};
/** Splats without area, which antialiasing makes invisible. */
const EMPTY: Readonly<Record<string, SplatValues>> = {
  'a point': { logScales: [-100, -100, -100] },
  'a line': { logScales: [-1, -100, -100], rotation: TURNED },
  'a line of a size that float32 could not square': { logScales: [88, -100, -100], rotation: TURNED },
};

/** Stacks of forty splats. */
const stack = defineEffect({
  name: 'test-stack',
  label: 'Stack',
  about: 'Puts splats behind each other.',
  hooks: { splat: 'stackSplat' },
  wgsl: `import package::lib::packing::Splat;
fn stackSplat(splat: Splat, splatIndex: u32) -> Splat {
  var stack = splat;
  stack.opacity = 40.0 * splat.opacity;
  return stack;
}`,
  calledFor: () => 'they are to be stacks',
});
const STACK_REFERENCE: EffectReference = {
  changeSplat: (splat) => ({ ...splat, opacity: 40 * splat.opacity }),
};

const gpu = testGpu();

async function draw(
  splats: Readonly<Record<string, SplatValues>>,
  camera: keyof typeof CAMERAS,
  effects = [antialias()],
) {
  const clouds = [{ set: splatsOf(Object.values(splats)), effects }];
  const effectReferences = { 'test-stack': () => STACK_REFERENCE };
  // No test looks at the order.
  const options = { clouds, camera: CAMERAS[camera], effectReferences, keyBits: 8, ...SIZE };
  return InspectedFrame.draw(gpu.device, options);
}

describe('antialias', () => {
  for (const camera of ['perspective', 'orthographic', 'telephoto'])
    gpuTest(`opacities are as in float64, ${camera}`, async () => {
      const frame = await draw(DRAWN, camera);
      const { stored, view, effects, dilationPx2 } = frame.clouds[0];
      expect(dilationPx2).toBe(ANTIALIAS_DILATION_PX2);
      const settings = { alphaCutoff: frame.accuracy.alphaCutoff, dilationPx2, effects };
      const references = Array.from({ length: stored.count }, (_, index) =>
        cullSplat(stored, index, view, frame.projection, settings),
      );
      const records = await readRecords(frame);
      const drawn = references.flatMap((reference, index) => (reference ? [index] : []));
      expect(records.map(({ splat }) => splat)).toEqual(drawn);
      for (const { splat, color } of records)
        expect(Math.abs(color[3] - references[splat]!.opacity), `splat ${splat}`).toBeLessThan(1e-6);
      expect(await findNonFinite(frame)).toEqual([]);
      frame.destroy();
    });

  gpuTest('opacities of stacks are as in float64, and those of single splats as they were', async () => {
    const frame = await draw(DRAWN, 'perspective', [stack(), antialias()]);
    const single = await draw(DRAWN, 'perspective');
    const { stored, view, effects, dilationPx2 } = frame.clouds[0];
    const settings = { alphaCutoff: frame.accuracy.alphaCutoff, dilationPx2, effects };
    const records = await readRecords(frame);
    const singles = await readRecords(single);
    expect(records.length).toBeGreaterThanOrEqual(singles.length);
    let thinned = 0;
    for (const { splat, color } of records) {
      const expected = cullSplat(stored, splat, view, frame.projection, settings)!.opacity;
      expect(Math.abs(color[3] / expected - 1), `splat ${splat}`).toBeLessThan(1e-5);
      const one = singles.find((each) => each.splat === splat);
      if (one && one.color[3] < 0.9 && color[3] < 0.95 * 40 * one.color[3]) thinned++;
    }
    expect(thinned).toBeGreaterThan(1);
    for (const each of [frame, single]) each.destroy();
  });

  gpuTest('is on as the file was trained, at another width, or off', async () => {
    // Images are compared bit for bit: their rasteriser must not follow from times.
    const engine = await SplatEngine.create({
      device: gpu.device,
      accuracy: { preset: 'high', rasterizer: 'tiles' },
    });
    const view = engine.createView();
    const camera = CAMERAS.perspective;
    const set = splatsOf(Object.values(DRAWN));
    const trained = { ...set, isAntialiased: true };
    const draw = async (instance: CloudInstance) => {
      view.render({ camera, clouds: [instance], ...SIZE });
      return (await view.readPixels()).data;
    };
    const [cloud, trainedCloud] = [engine.add(set), engine.add(trained)];
    const asTrained = await draw({ cloud: trainedCloud });
    expect(asTrained).toEqual(await draw({ cloud, effects: [antialias({ dilationPx2: DILATION_PX2 })] }));
    for (const options of [undefined, true, {}, { dilationPx2: DILATION_PX2 }])
      expect(await draw({ cloud: trainedCloud, effects: [antialias(options)] })).toEqual(asTrained);
    const narrow = await draw({ cloud, effects: [antialias()] });
    expect(narrow).not.toEqual(asTrained);
    const narrower = antialias({ dilationPx2: ANTIALIAS_DILATION_PX2 });
    expect(await draw({ cloud, effects: [narrower] })).toEqual(narrow);
    expect(await draw({ cloud: trainedCloud, effects: [narrower] })).toEqual(narrow);
    const off = await draw({ cloud: trainedCloud, effects: [antialias(false)] });
    expect(off).toEqual(await draw({ cloud }));
    expect(off).not.toEqual(asTrained);
    const clouds = { trained: { set: trained }, narrow: { set, effects: [antialias()] } };
    for (const [name, image] of Object.entries({ trained: asTrained, narrow })) {
      const reference = renderReference({ clouds: [clouds[name as keyof typeof clouds]], camera, ...SIZE });
      expect(compareImages(image, reference.data, SIZE).psnrDb, name).toBeGreaterThan(60);
    }
    engine.destroy();
  });

  gpuTest('clouds of one frame are each filtered by their own width', async () => {
    const sets = [0, 1].map((seed) => randomSplats({ count: 300, seed, shDegree: 0, logScales: [-5, -2] }));
    const [narrow, wide] = [antialias({ dilationPx2: 0.05 }), antialias({ dilationPx2: 0.9 })];
    const clouds = [
      { set: sets[0], effects: [narrow] },
      { set: sets[1] },
      { set: { ...sets[1], isAntialiased: true } },
      { set: sets[0], effects: [wide] },
    ];
    const counts = await expectAsReference(
      gpu.device,
      { clouds, camera: CAMERAS.perspective, ...SIZE },
      1e-4,
    );
    expect(Math.min(...counts)).toBeGreaterThan(50);
  });

  test.each([0, -1, 2, Number.NaN, '0.1', null])('refuses a width of %s', (dilationPx2) => {
    const told = expect.objectContaining({ message: expect.stringContaining('dilationPx2') });
    expect(() => antialias({ dilationPx2: dilationPx2 as number })).toThrow(told);
    expect(() => antialias({ dilationPx2: dilationPx2 as number })).toThrow(InvalidArgumentError);
  });

  test('tells the width that a cloud is drawn with', () => {
    expect(antialias().reason).toContain('0.1 px²');
    expect(antialias({ dilationPx2: 0.3 }).reason).toContain('0.3 px²');
    expect(antialias({ dilationPx2: 0.2 }).reason).toContain('0.2 px²');
    expect(antialias(false).reason).toBeNull();
  });

  gpuTest('splats without area are not drawn', async () => {
    const frame = await draw(EMPTY, 'perspective');
    expect(await frame.visibleCount()).toBe(0);
    frame.destroy();
  });
});
