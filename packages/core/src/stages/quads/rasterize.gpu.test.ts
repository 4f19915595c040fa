import { gpuTest } from '@websplatter/node/gpu-test';
import { beforeAll, describe, expect } from 'vitest';
import { SplatRecordF32 } from '../../data/layout/structs.ts';
import type { RenderState } from '../../gpu/pipelines.ts';
import { readTexture } from '../../gpu/read-texture.ts';
import { FLOAT32_ROUNDING } from '../../inspect/error-bounds.ts';
import { reachSquared } from '../../reference/stacked-opacity.ts';
import { packFlatView } from '../../testing/flat-view.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { testGpu } from '../../testing/test-gpu.ts';
import { MERGED_OPACITIES } from '../../testing/tile-buffers.ts';
import type { VisibleSplat } from '../cull/cull.reference.ts';
import { rasterizeSplat } from './quads.reference.ts';
import { rasterize } from './quads.ts';

const ALPHA_CUTOFF = 1 / 255;

const gpu = testGpu();
const FORMAT = 'rgba32float';
const variant = { recordPrecision: 'f32', extent: 'opacity', depth: null } as const;
const stages = { single: rasterize(variant), merged: rasterize({ ...variant, isStacked: true }) };
/** Unblended: a single splat needs no blending, and rgba32float may not blend. */
const state: RenderState = { topology: 'triangle-strip', targets: [{ format: FORMAT }] };

beforeAll(async () => {
  await gpu.pipelines.prepare(Object.values(stages).map((stage) => [stage, state] as const));
});

/** A splat to draw. */
interface DrawnSplat {
  readonly centerPx: readonly [number, number];
  /** Half axes at √2 standard deviations, px. */
  readonly majorLengthPx: number;
  readonly minorLengthPx: number;
  /** Angle of the major axis, from the image's x to its y, which points down. */
  readonly angle: number;
  readonly opacity: number;
}

const COLOR = [0.75, 0.5, 0.25] as const;

async function drawOnGpu(splat: DrawnSplat, widthPx: number, heightPx: number) {
  const stage = splat.opacity > 1 ? stages.merged : stages.single;
  const view = packFlatView({ size: { widthPx, heightPx }, alphaCutoff: ALPHA_CUTOFF, dispatchRow: 1 });
  const record = new ArrayBuffer(SplatRecordF32.bytes);
  const { majorLengthPx, minorLengthPx, angle, centerPx, opacity } = splat;
  SplatRecordF32.write(record, {
    centerPx,
    majorPx: [majorLengthPx * Math.cos(angle), majorLengthPx * Math.sin(angle)],
    minorLengthPx,
    depthView: 1,
    color: [...COLOR, opacity],
  });
  const target = gpu.device.createTexture({
    size: [widthPx, heightPx],
    format: FORMAT,
    usage: GPUTextureUsage.RENDER_ATTACHMENT | GPUTextureUsage.COPY_SRC,
  });
  const encoder = gpu.device.createCommandEncoder();
  const pass = encoder.beginRenderPass({
    colorAttachments: [{ view: target.createView(), loadOp: 'clear', storeOp: 'store' }],
  });
  pass.setPipeline(gpu.pipelines.render(stage, state)!);
  pass.setBindGroup(
    0,
    gpu.pipelines.bindGroup(stage, {
      view: gpu.uniform(view),
      order: gpu.storage([0]),
      records: gpu.storage(new Uint32Array(record)),
    }),
  );
  pass.draw(4);
  pass.end();
  gpu.device.queue.submit([encoder.finish()]);
  const { data } = await readTexture(gpu.device, target);
  target.destroy();
  return data;
}

/** Draws the splat by the reference, from exactly the float32 numbers that the GPU reads. */
function drawByReference(splat: DrawnSplat, widthPx: number, heightPx: number) {
  const [majorX, majorY] = [Math.cos(splat.angle), Math.sin(splat.angle)].map((v) =>
    Math.fround(splat.majorLengthPx * v),
  );
  const minorLength = Math.fround(splat.minorLengthPx);
  const length2 = majorX * majorX + majorY * majorY;
  const minor2 = (minorLength * minorLength) / length2;
  const covariance = {
    a: (majorX * majorX + minor2 * majorY * majorY) / 2,
    b: ((1 - minor2) * majorX * majorY) / 2,
    c: (majorY * majorY + minor2 * majorX * majorX) / 2,
    determinant: (length2 * minorLength * minorLength) / 4,
  };
  const visible: VisibleSplat = {
    depthView: 1,
    centerPx: [Math.fround(splat.centerPx[0]), Math.fround(splat.centerPx[1])],
    covariance,
    opacity: Math.fround(splat.opacity),
    isStacked: true,
    // The whole image, so that pixels that the GPU's quad misses are found.
    extentPx: [1e9, 1e9],
  };
  const image = { widthPx, heightPx, data: new Float64Array(4 * widthPx * heightPx) };
  // Twice: with the cutoff, and without it to find the pixels that are close to it.
  const everywhere = { widthPx, heightPx, data: new Float64Array(4 * widthPx * heightPx) };
  rasterizeSplat(image, visible, COLOR, ALPHA_CUTOFF);
  rasterizeSplat(everywhere, visible, COLOR, 0);
  return { expected: image.data, alphas: everywhere.data };
}

/** Compares every pixel; returns the number of pixels that the splat covers. */
async function check(splat: DrawnSplat, widthPx = 64, heightPx = 48): Promise<number> {
  const actual = await drawOnGpu(splat, widthPx, heightPx);
  const { expected, alphas } = drawByReference(splat, widthPx, heightPx);
  // Interpolation is linear between corners: it errs by some roundings of the largest local
  // coordinate that a corner has, on the box or on the ellipse's own quad, whose sides reach two
  // standard units and a snapping step further.
  const reach = Math.sqrt(reachSquared(splat.opacity, ALPHA_CUTOFF));
  const farthestPx = Math.hypot(widthPx + 2, heightPx + 2, splat.centerPx[0], splat.centerPx[1]);
  const quadLocal = 2 * reach + 0.1 / splat.minorLengthPx;
  const largestLocal = Math.max(quadLocal, farthestPx / splat.minorLengthPx);
  const localError = 16 * FLOAT32_ROUNDING * largestLocal;
  // |d exp(−p²)/dp| ≤ 0.86, and of a stack |dα/dp| ≤ 2p; `exp` itself errs by up to 3 + 2|x| ulp.
  const slope = splat.opacity > 1 ? 2 * reach : 0.86 * splat.opacity;
  const bound = slope * localError + (splat.opacity > 1 ? 128 : 32) * FLOAT32_ROUNDING;
  let covered = 0;
  for (let i = 0; i < expected.length; i++) {
    const alpha = alphas[4 * (i >> 2) + 3];
    if (i % 4 === 3 && expected[i] > 0) covered++;
    // Rounding decides whether such a pixel is drawn.
    if (Math.abs(alpha - ALPHA_CUTOFF) <= bound) continue;
    if (!(Math.abs(actual[i] - expected[i]) <= bound)) {
      const pixel = i >> 2;
      const place = `column ${pixel % widthPx}, row ${Math.floor(pixel / widthPx)}, channel ${i % 4}`;
      expect.fail(
        `${place}: got ${actual[i]}, expected ${expected[i]} ± ${bound}\nof ${JSON.stringify(splat)}`,
      );
    }
  }
  return covered;
}

const ROUND = { majorLengthPx: 6, minorLengthPx: 6, angle: 0, opacity: 0.8 } as const;

describe('rasterize', () => {
  gpuTest('round, long and small splats anywhere, at any angle and opacity', async () => {
    const random = seededRandom(21);
    let covered = 0;
    for (let i = 0; i < 120; i++) {
      const minorLengthPx = 0.78 * 60 ** random();
      covered += await check({
        centerPx: [-20 + 104 * random(), -20 + 88 * random()],
        minorLengthPx,
        majorLengthPx: minorLengthPx * 100 ** (random() * random()),
        angle: 2 * Math.PI * random(),
        opacity: ALPHA_CUTOFF * 255 ** random(),
      });
    }
    expect(covered).toBeGreaterThan(10_000);
  });

  gpuTest('a splat of full opacity is capped at 0.99', async () => {
    const splat = { ...ROUND, centerPx: [10.5, 20.5], opacity: 1 } as const;
    await check(splat);
    const data = await drawOnGpu(splat, 64, 48);
    expect(data[4 * (20 * 64 + 10) + 3]).toBeCloseTo(0.99, 6);
  });

  gpuTest('merged splats, thin and round, small and huge: to the pixels where the stack ends', async () => {
    for (const opacity of MERGED_OPACITIES) {
      for (const [majorLengthPx, minorLengthPx] of [
        [0.78, 0.78],
        [5, 5],
        [14, 2],
        [1e4, 0.7746],
        [1e12, 20],
        [1e18, 1e18],
      ]) {
        const covered = await check({
          centerPx: [30.3, 21.8],
          majorLengthPx,
          minorLengthPx,
          angle: 0.6,
          opacity,
        });
        expect(covered).toBeGreaterThan(3);
      }
    }
  });

  gpuTest('needles at every angle', async () => {
    for (let i = 0; i < 24; i++) {
      const angle = (i * Math.PI) / 24;
      const covered = await check({
        centerPx: [32.3, 23.8],
        majorLengthPx: 1e4,
        minorLengthPx: 0.7746,
        angle,
        opacity: 0.9,
      });
      expect(covered).toBeGreaterThan(48);
    }
  });

  gpuTest('huge splats across the image, with centres inside it or far outside', async () => {
    for (const majorLengthPx of [1e3, 7e4, 1e7, 1e12, 1e18]) {
      for (const minorLengthPx of [20, 1e3, majorLengthPx]) {
        for (const centerPx of [
          [30, 20],
          [-900, 20],
          [30, 2000],
        ] as const) {
          await check({ centerPx, majorLengthPx, minorLengthPx, angle: 0.7, opacity: 0.99 });
        }
      }
    }
    // At least the last of them covers everything.
    const covered = await check({
      centerPx: [30, 20],
      majorLengthPx: 1e18,
      minorLengthPx: 1e18,
      angle: 0,
      opacity: 0.5,
    });
    expect(covered).toBe(64 * 48);
  });

  gpuTest('splats centred outside of the image whose rims reach into it', async () => {
    for (const centerPx of [
      [-5, 20.2],
      [69, 20.2],
      [30, -5],
      [30, 53],
      [-4, -4],
    ] as const) {
      expect(await check({ ...ROUND, centerPx })).toBeGreaterThan(0);
    }
    expect(await check({ ...ROUND, centerPx: [-40, 20] })).toBe(0);
  });

  gpuTest('an image of one pixel, and one wider than the guard band', async () => {
    expect(await check({ ...ROUND, centerPx: [0.2, 0.9] }, 1, 1)).toBe(1);
    await check(
      { ...ROUND, centerPx: [7000.3, 1.5], majorLengthPx: 900, minorLengthPx: 3, angle: 0.01 },
      8192,
      3,
    );
  });
});
