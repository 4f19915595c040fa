// Proves: a moving scene is drawn at a time as in float64, and chunks without a splat there are culled.
import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { SplatEngine } from '../../../create-engine.ts';
import { MOTION_SLOT, MOTION_VALUES } from '../../../data/splats/splat-motion.ts';
import { SplatSelection } from '../../../data/splats/splat-selection.ts';
import { compareCulling } from '../../../inspect/compare-culling.ts';
import { InspectedFrame } from '../../../inspect/inspected-frame.ts';
import { compareImages, renderReference } from '../../../reference/index.ts';
import { expectAsReference } from '../../../testing/expect-as-reference.ts';
import { movingSplats } from '../../../testing/moving-splats.ts';
import { TEST_MODELS, testCameras } from '../../../testing/test-cameras.ts';
import { testGpu } from '../../../testing/test-gpu.ts';
import { highlight } from '../highlight/highlight.ts';

const SIZE = { widthPx: 48, heightPx: 48 };
const CAMERAS = testCameras(1);
const TIMES = [0, 0.25, 0.5, 1];
const SET = movingSplats({ count: 1500, seed: 90, shDegree: 1 });

/** Without turns, which the GPU has in float16: everything else is as exact as float32. */
const UNTURNED = {
  ...SET,
  motion: SET.motion.map((value, i) => (i % MOTION_VALUES < MOTION_SLOT.turn ? value : 0)),
};
/** Errors relative to the size of a splat, by what is drawn. */
const TOLERANCES = [
  [UNTURNED, 3e-5],
  [SET, 3e-3],
] as const;

const gpu = testGpu();

describe('motion', () => {
  for (const geometryPrecision of ['f32', 'packed'] as const)
    gpuTest(`each splat at each time, ${geometryPrecision}`, async () => {
      for (const camera of ['perspective', 'inside', 'orthographic'] as const) {
        for (const [set, tolerance] of TOLERANCES) {
          // A cloud drawn at each time, in one frame.
          const clouds = TIMES.map((time) => ({ set, time, modelMatrix: TEST_MODELS.sheared }));
          const options = { clouds, camera: CAMERAS[camera], accuracy: { geometryPrecision }, ...SIZE };
          for (const count of await expectAsReference(gpu.device, options, tolerance))
            expect(count).toBeGreaterThan(50);
        }
      }
    });

  gpuTest('pictures at each time, before the first and after the last', async () => {
    const engine = await SplatEngine.create({ device: gpu.device, accuracy: 'high' });
    const cloud = engine.add(SET);
    expect(cloud.timeRange).toEqual([0, 1]);
    const view = engine.createView();
    const picture = async (time?: number) => {
      view.render({ camera: CAMERAS.perspective, clouds: [{ cloud, time }], ...SIZE });
      return (await view.readPixels()).data;
    };
    for (const time of TIMES) {
      const { data } = renderReference({
        clouds: [{ set: SET, time }],
        camera: CAMERAS.perspective,
        ...SIZE,
      });
      expect(compareImages(await picture(time), data, SIZE).psnrDb).toBeGreaterThan(70);
    }
    expect(await picture()).toEqual(await picture(0));
    expect(await picture(-3)).toEqual(await picture(0));
    expect(await picture(7)).toEqual(await picture(1));
    expect(() =>
      view.render({ camera: CAMERAS.perspective, clouds: [{ cloud, time: Number.NaN }], ...SIZE }),
    ).toThrow(/time is NaN.*a finite number/);
    engine.destroy();
  });

  gpuTest('chunks that are elsewhere or have no splat at the time are culled, no splat is lost', async () => {
    // The first half is there early and the second late, each in chunks of its own.
    const set = movingSplats({ count: 2048, seed: 91, shDegree: 0, halfExtent: 0.3, logScales: [-6, -4] });
    for (let i = 0; i < set.count; i++) {
      const isLate = i >= set.count / 2;
      set.positions[3 * i] += isLate ? 2 : -2;
      set.motion[i * MOTION_VALUES + MOTION_SLOT.time] = isLate ? 0.9 : 0.1;
      set.motion[i * MOTION_VALUES + MOTION_SLOT.logDuration] = -3;
      // At its time, each half is in the middle of the picture; without its velocity it would be outside.
      set.motion[i * MOTION_VALUES + MOTION_SLOT.velocity] = 0;
    }
    const chunksAt = async (time: number) => {
      const modelMatrix = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, time < 0.5 ? 2 : -2, 0, 0, 1];
      const clouds = [{ set, time, modelMatrix }];
      const frame = await InspectedFrame.draw(gpu.device, { clouds, camera: CAMERAS.perspective, ...SIZE });
      const { visibleCount, mismatches, flaws } = await compareCulling(frame);
      expect([mismatches, flaws]).toEqual([[], []]);
      const [slots] = await frame.words('slotCount');
      frame.destroy();
      return { slots, visibleCount };
    };
    for (const time of [0.1, 0.9]) expect(await chunksAt(time)).toMatchObject({ slots: 4 });
    expect(await chunksAt(0.5)).toEqual({ slots: 0, visibleCount: 0 });
  });

  gpuTest('a chunk whose splats move into the picture is drawn', async () => {
    const set = movingSplats({ count: 256, seed: 92, shDegree: 0, halfExtent: 0.3 });
    for (let i = 0; i < set.count; i++) {
      const at = i * MOTION_VALUES;
      set.positions[3 * i] += 50;
      set.motion.set([0, 2, -100, 0, 0, 0, 0, 0, 0, 0, 0], at);
    }
    const options = { clouds: [{ set, time: 0.5 }], camera: CAMERAS.perspective, ...SIZE };
    const [count] = await expectAsReference(gpu.device, options, 1e-3);
    expect(count).toBeGreaterThan(100);
  });

  gpuTest('with a selection', async () => {
    const selection = new SplatSelection();
    selection.add(Array.from({ length: 700 }, (_, i) => 2 * i));
    const effects = [highlight({ selection, color: [1, 0, 0], strength: 0.7 })];
    const clouds = [{ set: UNTURNED, time: 0.4, effects }];
    await expectAsReference(gpu.device, { clouds, camera: CAMERAS.perspective, ...SIZE }, 3e-5);
  });

  gpuTest('instances', async () => {
    const engine = await SplatEngine.create({ device: gpu.device, accuracy: 'high' });
    const cloud = engine.add(SET);
    const view = engine.createView();
    const place = (x: number) => [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, 0, 0, 1];
    const request = { camera: CAMERAS.perspective, ...SIZE };
    const picture = async (clouds: Parameters<typeof view.render>[0]['clouds']) => {
      view.render({ ...request, clouds });
      return (await view.readPixels()).data;
    };
    const modelMatrices = [...place(0.4), ...place(-0.5)];
    const together = await picture([{ cloud, time: 0.6, instances: { modelMatrices } }]);
    const apart = await picture([
      { cloud, time: 0.6, modelMatrix: place(0.4) },
      { cloud, time: 0.6, modelMatrix: place(-0.5) },
    ]);
    expect(together).toEqual(apart);
    engine.destroy();
  });
});
