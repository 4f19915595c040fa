import { createTestDevice, gpuTest } from '@websplatter/node/gpu-test';
import { afterAll, beforeAll, describe, expect } from 'vitest';
import { type AccuracySettings, DILATION_PX2 } from '../accuracy.ts';
import type { Projection } from '../camera.ts';
import { FLOAT32_ROUNDING, projectionErrors } from '../inspect/error-bounds.ts';
import { type InspectedCloud, InspectedFrame, type InspectOptions } from '../inspect/inspected-frame.ts';
import { orderedBits } from '../layout/depth-key.ts';
import { ProjectedSplatF32 } from '../layout/structs.ts';
import { cullSplat } from '../reference/cull-splats.ts';
import { randomSplats } from '../testing/random-splats.ts';
import { TEST_MODELS, testCameras } from '../testing/test-cameras.ts';

let device: GPUDevice;
beforeAll(async () => {
  device = await createTestDevice();
});
afterAll(() => device.destroy());

const SIZE = { widthPx: 48, heightPx: 32 };
const SPLATS = 1500;

/**
 * Whether the twin draws the splat, and whether rounding may decide otherwise: asked again with cutoff, near, far and
 * the picture's edges moved by what float32 may err, once against the splat and once for it.
 */
function verdict(
  { stored, view }: InspectedCloud,
  index: number,
  projection: Projection,
  { alphaCutoff }: AccuracySettings,
) {
  const errors = projectionErrors(stored, index, view, projection);
  const drawn = (direction: -1 | 0 | 1) => {
    // The Gaussian reaches at most 3.4 standard deviations; its extent errs by that many times the rows' error.
    const edgePx = (axis: 0 | 1) => direction * (errors.centerPx[axis] + 4 * errors.rowsPx + 1e-5);
    const moved = {
      ...projection,
      widthPx: projection.widthPx + 2 * edgePx(0),
      heightPx: projection.heightPx + 2 * edgePx(1),
      centerPx: [projection.centerPx[0] + edgePx(0), projection.centerPx[1] + edgePx(1)] as const,
      near: projection.near - direction * (errors.depthView + FLOAT32_ROUNDING * projection.near),
      far: projection.far + direction * (errors.depthView + FLOAT32_ROUNDING * projection.far),
    };
    // Opacity and cutoff are rounded to float32, and `log` errs by 3 ulp: the same as another cutoff.
    const cutoff = alphaCutoff * (1 - direction * 16 * FLOAT32_ROUNDING);
    return cullSplat(stored, index, view, moved, { alphaCutoff: cutoff, dilationPx2: DILATION_PX2 }) !== null;
  };
  return { isDrawn: drawn(0), isSure: drawn(-1) === drawn(1) };
}

/** Draws the frame and compares every splat's fate; answers how many were drawn and how many left to rounding. */
async function check(options: Omit<InspectOptions, 'widthPx' | 'heightPx' | 'keyBits'>) {
  const frame = await InspectedFrame.draw(device, { ...options, ...SIZE, keyBits: 8 });
  const visibleCount = await frame.visibleCount();
  const survivors = (await frame.words('survivors')).subarray(0, visibleCount);
  const drawn = new Set(survivors);
  expect(drawn.size).toBe(visibleCount);
  expect(survivors.every((splat, i) => i === 0 || survivors[i - 1] < splat)).toBe(true);

  let unsure = 0;
  const mismatches: unknown[] = [];
  let firstSplat = 0;
  for (const [cloudIndex, cloud] of frame.clouds.entries()) {
    for (let index = 0; index < cloud.stored.count; index++) {
      const { isDrawn, isSure } = verdict(cloud, index, frame.projection, frame.accuracy);
      const onGpu = drawn.has(firstSplat + index);
      if (!isSure) unsure++;
      else if (onGpu !== isDrawn) mismatches.push({ cloudIndex, index, expected: isDrawn, got: onGpu });
    }
    firstSplat += 256 * Math.ceil(cloud.stored.count / 256);
  }
  expect(mismatches.length, `first: ${JSON.stringify(mismatches[0])}`).toBe(0);

  // The range of depths is that of the very depths that were written.
  const records = new Float32Array((await frame.words('projected')).buffer);
  const depths = Array.from(survivors, (_, i) =>
    orderedBits(records[(i * ProjectedSplatF32.bytes + ProjectedSplatF32.offsets.depthView) / 4]),
  );
  const [farthest, nearestInverted] = await frame.words('depthRange');
  if (visibleCount > 0) {
    expect(farthest).toBe(Math.max(...depths));
    expect(~nearestInverted >>> 0).toBe(Math.min(...depths));
  }
  frame.destroy();
  return { visibleCount, unsure };
}

describe('cull-splats', () => {
  for (const [name, camera] of Object.entries(testCameras(1.5))) {
    gpuTest(`${name} camera: draws what the twin draws`, async () => {
      const set = randomSplats({ count: SPLATS, shDegree: 0, seed: 7 });
      const { visibleCount, unsure } = await check({ clouds: [{ set }], camera });
      expect(visibleCount).toBeGreaterThan(SPLATS / 50);
      expect(unsure).toBeLessThan(SPLATS / 100);
    });
  }

  for (const [name, modelMatrix] of Object.entries(TEST_MODELS)) {
    gpuTest(`${name} model, packed, two pages, rows of 2 workgroups`, async () => {
      const set = randomSplats({ count: SPLATS, shDegree: 0, seed: 8 });
      const { visibleCount, unsure } = await check({
        clouds: [
          { set, modelMatrix, splatsPerPage: 1024 },
          { set: randomSplats({ count: 100, shDegree: 0, seed: 9 }) },
        ],
        camera: testCameras(1.5).perspective,
        accuracy: { geometryPrecision: 'packed' },
        dispatchRow: 2,
      });
      expect(visibleCount).toBeGreaterThan(SPLATS / 50);
      expect(unsure).toBeLessThan(SPLATS / 100);
    });
  }

  gpuTest('faint splats, large ones around the eye, and a high cutoff', async () => {
    const camera = testCameras(1.5).inside;
    const faint = randomSplats({ count: SPLATS, shDegree: 0, opacityLogits: [-5.7, -5.4] });
    const large = randomSplats({ count: SPLATS, shDegree: 0, seed: 3, logScales: [-3, 3] });
    for (const alphaCutoff of [1 / 255, 0.05]) {
      const { visibleCount } = await check({
        clouds: [{ set: faint }, { set: large }],
        camera,
        accuracy: { alphaCutoff },
      });
      expect(visibleCount).toBeGreaterThan(SPLATS / 4);
    }
  });

  gpuTest('nothing to see', async () => {
    const set = randomSplats({ count: 300, shDegree: 0, opacityLogits: [-9, -7] });
    const { visibleCount } = await check({ clouds: [{ set }], camera: testCameras(1.5).perspective });
    expect(visibleCount).toBe(0);
  });
});
