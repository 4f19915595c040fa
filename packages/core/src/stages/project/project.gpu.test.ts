// Proves: every record and key as the reference's: cameras, models, degrees, precisions.
import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { DILATION_PX2 } from '../../data/accuracy/accuracy.ts';
import { perspectiveCamera } from '../../data/camera/camera.ts';
import { shortDepthKey } from '../../data/layout/depth-key.ts';
import { Pipelines } from '../../gpu/pipelines.ts';
import { compareCulling } from '../../inspect/compare-culling.ts';
import { compareOrder } from '../../inspect/compare-order.ts';
import { compareRecords, RECORD_FIELDS } from '../../inspect/compare-records.ts';
import { describeFieldError } from '../../inspect/field-error.ts';
import { findNonFinite } from '../../inspect/find-non-finite.ts';
import { InspectedFrame, type InspectOptions } from '../../inspect/inspected-frame.ts';
import { readRecords } from '../../inspect/read-records.ts';
import { paletteSplats } from '../../testing/palette-splats.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { TEST_MODELS, testCameras } from '../../testing/test-cameras.ts';
import { testGpu } from '../../testing/test-gpu.ts';

const gpu = testGpu();

const isFull = process.env.WEBSPLATTER_FULL === '1';

const SIZE = { widthPx: 48, heightPx: 32 };
const SPLATS = 1000;

async function check(options: Omit<InspectOptions, 'widthPx' | 'heightPx' | 'keyBits'>) {
  const frame = await InspectedFrame.draw(gpu.device, { ...options, ...SIZE, keyBits: 8 });
  const records = await readRecords(frame);
  expect(records.length).toBeGreaterThan(SPLATS / 50);
  // Dilation makes every axis this long, so that shaders may divide by it; float16 rounds it.
  const shortest =
    Math.sqrt(2 * DILATION_PX2) * (frame.accuracy.recordPrecision === 'paper' ? 0.999 : 0.99999);
  for (const { minorLengthPx } of records) expect(minorLengthPx).toBeGreaterThanOrEqual(shortest);
  const { firstBad, worst } = await compareRecords(frame);
  if (firstBad) expect.fail(describeFieldError(firstBad));
  expect(Object.keys(worst).sort()).toEqual([...RECORD_FIELDS].sort());
  expect(await compareOrder(frame)).toEqual([]);
  expect(await findNonFinite(frame)).toEqual([]);
  frame.destroy();
}

describe('project', () => {
  for (const [name, camera] of Object.entries(testCameras(1.5))) {
    gpuTest(`${name} camera, degree 3`, () =>
      check({ clouds: [{ set: randomSplats({ count: SPLATS, seed: 11 }) }], camera }),
    );
  }

  for (const [name, modelMatrix] of Object.entries(TEST_MODELS)) {
    if (!isFull && !['mirrored', 'sheared'].includes(name)) continue;
    const what = 'packed geometry, u8 harmonics, f16 records, two pages and clouds';
    gpuTest(`${name} model, ${what}`, { tags: 'deeper' }, () =>
      check({
        clouds: [
          { set: randomSplats({ count: SPLATS, seed: 12 }), modelMatrix, splatsPerPage: 512 },
          { set: randomSplats({ count: 100, seed: 13, shDegree: 1 }) },
        ],
        camera: testCameras(1.5).perspective,
        accuracy: { geometryPrecision: 'packed', shPrecision: 'u8', recordPrecision: 'f16' },
        dispatchRow: 1,
      }),
    );
  }

  for (const stored of [0, 1, 2, 3] as const) {
    for (const evaluated of [0, 1, 2, 3] as const) {
      if (evaluated > stored) continue;
      // In the first tier, each degree is evaluated once: none, a part, or all of what is stored.
      if (!isFull && stored !== [2, 3, 2, 3][evaluated]) continue;
      gpuTest(`degree ${evaluated} of ${stored} stored, f16 harmonics`, { tags: 'deeper' }, () =>
        check({
          clouds: [{ set: randomSplats({ count: SPLATS, seed: 14, shDegree: stored }), shDegree: evaluated }],
          camera: testCameras(1.5).inside,
          accuracy: { shPrecision: 'f16' },
        }),
      );
    }
  }

  for (const shDegree of [1, 2, 3] as const) {
    gpuTest(`palettes of degree ${shDegree}, several pages and clouds`, () =>
      check({
        clouds: [
          {
            set: paletteSplats({ count: SPLATS + 1, entryCount: 37, shDegree }),
            shDegree: 2,
            splatsPerPage: 512,
          },
          { set: randomSplats({ count: 100, seed: 13, shDegree: 1 }) },
          {
            set: paletteSplats({ count: 1, entryCount: 1, shDegree, seed: 3, logScales: [-1, -1] }),
            shDegree: 2,
          },
        ],
        camera: testCameras(1.5).inside,
        accuracy: { shPrecision: 'u8' },
      }),
    );
  }

  for (const [geometryPrecision, recordPrecision] of [
    ['f32', 'f32'],
    ['packed', 'f16'],
  ] as const) {
    gpuTest(`clouds of any opacity, ${geometryPrecision} geometry, ${recordPrecision} records`, () =>
      check({
        clouds: [0.5, 0.01, 1, 0].map((opacity, i) => ({
          set: randomSplats({ count: SPLATS, seed: 20 + i, shDegree: 0 }),
          opacity,
        })),
        camera: testCameras(1.5).perspective,
        accuracy: { geometryPrecision, recordPrecision },
      }),
    );
  }

  // Records are packed alike for all cameras, each of which has a test with records of f32.
  for (const [name, camera] of Object.entries(testCameras(1.5))) {
    if (!isFull && !['perspective', 'orthographic'].includes(name)) continue;
    gpuTest(`records as in the paper, ${name} camera`, { tags: 'deeper' }, () =>
      check({
        clouds: [
          { set: randomSplats({ count: SPLATS, seed: 11 }) },
          { set: randomSplats({ count: SPLATS, seed: 15, shDegree: 0, logScales: [-18, 1] }), opacity: 0.5 },
          // Axes that float16 cannot hold.
          { set: randomSplats({ count: SPLATS, seed: 16, shDegree: 0, logScales: [-40, 40] }) },
        ],
        camera,
        accuracy: { recordPrecision: 'paper' },
      }),
    );
  }

  for (const sortKeyBits of [24, 16] as const) {
    gpuTest(`keys of ${sortKeyBits} bits: those of the depths, and their stable order`, async () => {
      const options = {
        clouds: [{ set: randomSplats({ count: 3000, seed: 30, shDegree: 0, halfExtent: 40 }) }],
        camera: testCameras(1.5).inside,
        accuracy: { sortKeyBits, alphaCutoff: 1 / 4096 },
      };
      await check(options);
      const frame = await InspectedFrame.draw(gpu.device, { ...options, ...SIZE });
      const { passes, digitBits } = frame.parts.sort.sort.shape;
      expect(passes * digitBits).toBeGreaterThanOrEqual(sortKeyBits);
      expect(passes).toBeLessThanOrEqual(Math.ceil(sortKeyBits / 8));
      expect(await compareOrder(frame)).toEqual([]);
      // Depths that differ in float32 must share keys, or shorter keys would gain nothing.
      const depths = new Set((await readRecords(frame)).map(({ depthView }) => depthView));
      const [farthest, nearestInverted] = await frame.words('depthRange');
      const range = farthest - (~nearestInverted >>> 0);
      expect(range).toBeGreaterThan(2 ** 24);
      const keys = [...depths].map((depth) =>
        shortDepthKey(depth, farthest, ~nearestInverted >>> 0, sortKeyBits),
      );
      expect(Math.max(...keys)).toBeLessThan(2 ** sortKeyBits);
      expect(Math.max(...keys)).toBeGreaterThanOrEqual(2 ** (sortKeyBits - 1));
      if (sortKeyBits === 16) expect(new Set(keys).size).toBeLessThan(depths.size);
      frame.destroy();
    });
  }

  gpuTest('keys of distances, of packed geometry in a sheared model too', async () => {
    const set = randomSplats({ count: SPLATS, seed: 18, shDegree: 0 });
    const options = { camera: testCameras(1.5).inside, sortBy: 'distance' } as const;
    await check({ ...options, clouds: [{ set }] });
    const clouds = [{ set, modelMatrix: TEST_MODELS.sheared }];
    await check({ ...options, clouds, accuracy: { geometryPrecision: 'packed' } });
  });

  for (const sortKeyBits of [32, 16] as const) {
    const name = `distances sorted by keys of ${sortKeyBits} bits, and what the comparison finds`;
    gpuTest(name, { tags: 'deeper' }, async () => {
      const options = {
        ...{
          clouds: [{ set: randomSplats({ count: 3000, seed: 30, shDegree: 0, halfExtent: 40 }) }],
          ...SIZE,
        },
        ...{ camera: testCameras(1.5).inside, accuracy: { sortKeyBits, alphaCutoff: 1 / 4096 } },
        sortBy: 'distance',
      } as const;
      const frame = await InspectedFrame.draw(gpu.device, options);
      expect(frame.parts.sort.sort.shape.passes).toBeGreaterThan(1);
      expect(await compareOrder(frame)).toEqual([]);
      frame.destroy();
      const mutation = {
        file: 'lib/depth-key',
        find: 'return dot(units, units);',
        replace: 'return units.z * units.z;',
      };
      for (const keyBits of isFull ? [8, sortKeyBits] : [sortKeyBits]) {
        const pipelines = new Pipelines(gpu.device, mutation);
        const wrong = await InspectedFrame.draw(gpu.device, { ...options, keyBits, pipelines });
        expect((await compareCulling(wrong)).flaws).not.toEqual([]);
        expect(await compareOrder(wrong)).not.toEqual([]);
        wrong.destroy();
      }
    });
  }

  gpuTest('needles, discs and points of every size', () =>
    check({
      clouds: [{ set: randomSplats({ count: SPLATS, seed: 15, shDegree: 0, logScales: [-18, 1] }) }],
      camera: testCameras(1.5).perspective,
    }),
  );

  gpuTest('the largest scales', () =>
    check({
      clouds: [{ set: randomSplats({ count: SPLATS, seed: 16, shDegree: 0, logScales: [-40, 40] }) }],
      camera: testCameras(1.5).perspective,
    }),
  );

  gpuTest('the largest scales right in front of the eye', () =>
    check({
      clouds: [
        {
          set: randomSplats({ count: SPLATS, seed: 17, shDegree: 0, halfExtent: 1e-4, logScales: [-40, 40] }),
        },
      ],
      camera: perspectiveCamera({
        position: [0, 0, 1e-4],
        target: [0, 0, 0],
        fovYDegrees: 20,
        aspect: 1.5,
        near: 1e-7,
      }),
    }),
  );
});
