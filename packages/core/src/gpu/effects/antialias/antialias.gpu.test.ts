import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { SplatEngine } from '../../../create-engine.ts';
import { DILATION_PX2 } from '../../../data/accuracy/accuracy.ts';
import type { CloudInstance } from '../../../frame/frame-request.ts';
import { findNonFinite } from '../../../inspect/find-non-finite.ts';
import { InspectedFrame } from '../../../inspect/inspected-frame.ts';
import { readRecords } from '../../../inspect/read-records.ts';
import type { EffectReference } from '../../../reference/effects/effect-reference.ts';
import { compareImages, renderReference } from '../../../reference/index.ts';
import { cullSplat } from '../../../stages/cull/cull.reference.ts';
import { type SplatValues, splatsOf } from '../../../testing/random-splats.ts';
import { testCameras } from '../../../testing/test-cameras.ts';
import { testGpu } from '../../../testing/test-gpu.ts';
import { defineEffect } from '../effect.ts';
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
  return InspectedFrame.draw(gpu.device, { clouds, camera: CAMERAS[camera], effectReferences, ...SIZE });
}

describe('antialias', () => {
  for (const camera of ['perspective', 'orthographic', 'telephoto'])
    gpuTest(`opacities are as in float64, ${camera}`, async () => {
      const frame = await draw(DRAWN, camera);
      const { stored, view, effects } = frame.clouds[0];
      const settings = { alphaCutoff: frame.accuracy.alphaCutoff, dilationPx2: DILATION_PX2, effects };
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
    const { stored, view, effects } = frame.clouds[0];
    const settings = { alphaCutoff: frame.accuracy.alphaCutoff, dilationPx2: DILATION_PX2, effects };
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

  gpuTest('is on automatically if the file says so, unless antialias(false) is given', async () => {
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
    const automatic = await draw({ cloud: trainedCloud });
    expect(automatic).toEqual(await draw({ cloud, effects: [antialias()] }));
    expect(automatic).toEqual(await draw({ cloud: trainedCloud, effects: [antialias()] }));
    const off = await draw({ cloud: trainedCloud, effects: [antialias(false)] });
    expect(off).toEqual(await draw({ cloud }));
    expect(off).not.toEqual(automatic);
    const reference = renderReference({ clouds: [{ set: trained }], camera, ...SIZE });
    expect(compareImages(automatic, reference.data, SIZE).psnrDb).toBeGreaterThan(60);
    engine.destroy();
  });

  gpuTest('splats without area are not drawn', async () => {
    const frame = await draw(EMPTY, 'perspective');
    expect(await frame.visibleCount()).toBe(0);
    frame.destroy();
  });
});
