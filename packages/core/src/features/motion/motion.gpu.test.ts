// Proves: a moving scene is drawn at a time as in float64, and chunks without a splat there are culled.
import { gpuTest } from '@websplatter/node/gpu-test';
import { beforeAll, describe, expect } from 'vitest';
import { SplatEngine } from '../../create-engine.ts';
import { SplatSelection } from '../../data/splats/splat-selection.ts';
import type { SplatSet } from '../../data/splats/splat-set.ts';
import { highlight } from '../../gpu/effects/highlight/highlight.ts';
import { compareCulling } from '../../inspect/compare-culling.ts';
import { InspectedFrame } from '../../inspect/inspected-frame.ts';
import { compareImages, renderReference } from '../../reference/index.ts';
import { expectAsReference } from '../../testing/expect-as-reference.ts';
import { movingSplats } from '../../testing/moving-splats.ts';
import { TEST_MODELS, testCameras } from '../../testing/test-cameras.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { MOST_MOTION, MOTION_SLOT, MOTION_VALUES } from './splat-motion.data.ts';
import { splatsAt } from './splats-at.data.ts';

const SIZE = { widthPx: 48, heightPx: 48 };
const isFull = process.env.WEBSPLATTER_FULL === '1';
const CAMERAS = testCameras(1);
const TIMES = [0, 0.25, 0.5, 1];
const SET = movingSplats({ count: 700, seed: 90, shDegree: 1 });

/** By one rasteriser: pictures are compared bit for bit. */
const HIGH = { preset: 'high', rasterizer: 'quads' } as const;

/** Errors relative to the size of a splat. */
const TOLERANCE = 3e-5;

/** Thin splats whose turns are up to `turn`, and rotations up to `length` on each axis. */
function turningSplats(turn: number, length: number): typeof SET {
  const set = movingSplats({ count: 150, seed: 93, shDegree: 0, logScales: [-5, -1.5] });
  return {
    ...set,
    rotations: set.rotations.map((value) => value * length),
    motion: set.motion.map((value, i) => (i % MOTION_VALUES < MOTION_SLOT.turn ? value : value * 2 * turn)),
  };
}

const gpu = testGpu();

describe('motion', () => {
  for (const geometryPrecision of ['f32', 'packed'] as const)
    gpuTest(`each splat at each time, ${geometryPrecision}`, { tags: 'deeper' }, async () => {
      // Only unpacking differs by precision.
      const all = ['perspective', 'inside', 'orthographic'] as const;
      for (const camera of isFull || geometryPrecision === 'f32' ? all : (['inside'] as const)) {
        // A cloud drawn at each time, in one frame.
        const clouds = TIMES.map((time) => ({ set: SET, time, modelMatrix: TEST_MODELS.sheared }));
        const options = { clouds, camera: CAMERAS[camera], accuracy: { geometryPrecision }, ...SIZE };
        for (const count of await expectAsReference(gpu.device, options, TOLERANCE))
          expect(count).toBeGreaterThan(50);
      }
    });

  const engines: Partial<Record<'f32' | 'packed', SplatEngine>> = {};
  beforeAll(async () => {
    // Splats of this size have no near ties of depth, which alone keys of 64 bits would tell apart.
    const accuracy = { preset: 'reference', sortKeyBits: 32 } as const;
    for (const geometryPrecision of ['f32', 'packed'] as const)
      engines[geometryPrecision] = await SplatEngine.create({
        device: gpu.device,
        accuracy: { ...accuracy, geometryPrecision },
      });
  });

  const turns = [
    [0.2, 1],
    [10, 1],
    [0.2, 1e-3],
    [0.2, 1e-6],
    [1e6, 1],
    [MOST_MOTION, 1],
    [MOST_MOTION, 1e-6],
    [MOST_MOTION, 1e-30],
    [1e-6, 1e30],
  ];
  const someTurns = [
    [10, 1],
    [0.2, 1e-6],
    [MOST_MOTION, 1],
    [MOST_MOTION, 1e-30],
    [1e-6, 1e30],
  ];
  /**
   * @fault Files: a moving scene's turns are long, or its rotations are short
   * @consequence each splat is drawn as in float64, up to the values that files may have
   */
  for (const [turn, length] of isFull ? turns : someTurns)
    gpuTest(`turns of ${turn} with rotations of ${length}`, { tags: 'deeper' }, async () => {
      const set = turningSplats(turn, length);
      const view = { camera: CAMERAS.perspective, ...SIZE };
      for (const geometryPrecision of ['f32', 'packed'] as const) {
        const engine = engines[geometryPrecision]!;
        const decibels = async (set: SplatSet, time?: number) => {
          const cloud = engine.add(set);
          const drawn = engine.createView();
          drawn.render({ ...view, clouds: [{ cloud, time }] });
          const { data } = await drawn.readPixels();
          const right = renderReference({ ...view, clouds: [{ set, time }] });
          drawn.destroy();
          cloud.destroy();
          return compareImages(data, right.data, SIZE).psnrDb;
        };
        for (const time of isFull ? TIMES : [0.25, 1]) {
          const moving = await decibels(set, time);
          expect(moving).toBeGreaterThan(80);
          // Rotations are rounded before they are turned.
          expect(moving).toBeGreaterThan(
            (await decibels(splatsAt(set, time))) - (geometryPrecision === 'f32' ? 0.1 : 4),
          );
        }
      }
    });

  gpuTest('a turn that cancels its rotation leaves the identity, or what is left beside it', async () => {
    for (const [left, geometryPrecision, tolerance] of [
      [0, 'f32', TOLERANCE],
      [0, 'packed', TOLERANCE],
      [1e-3, 'f32', 1e-3],
    ] as const) {
      const set = turningSplats(0, 1);
      for (let i = 0; i < set.count; i++) {
        const [w, x, y, z] = set.rotations.subarray(4 * i, 4 * i + 4);
        set.motion[i * MOTION_VALUES + MOTION_SLOT.time] = 0;
        const turn = [w + left * x, x - left * w, y + left * z, z - left * y].map((value) => -2 * value);
        set.motion.set(turn, i * MOTION_VALUES + MOTION_SLOT.turn);
      }
      const clouds = [{ set, time: 0.5 }];
      const options = { clouds, camera: CAMERAS.perspective, accuracy: { geometryPrecision }, ...SIZE };
      const [count] = await expectAsReference(gpu.device, options, tolerance);
      expect(count).toBeGreaterThan(20);
    }
  });

  gpuTest('pictures at each time, before the first and after the last', async () => {
    const engine = await SplatEngine.create({ device: gpu.device, accuracy: HIGH });
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
      const options = { clouds, camera: CAMERAS.perspective, keyBits: 8, ...SIZE };
      const frame = await InspectedFrame.draw(gpu.device, options);
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
    selection.add(Array.from({ length: 350 }, (_, i) => 2 * i));
    const effects = [highlight({ selection, color: [1, 0, 0], strength: 0.7 })];
    const clouds = [{ set: SET, time: 0.4, effects }];
    await expectAsReference(gpu.device, { clouds, camera: CAMERAS.perspective, ...SIZE }, TOLERANCE);
  });

  gpuTest('instances', async () => {
    const engine = await SplatEngine.create({ device: gpu.device, accuracy: HIGH });
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
