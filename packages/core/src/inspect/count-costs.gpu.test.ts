import { gpuTest } from '@websplatter/node/gpu-test';
import { describe, expect } from 'vitest';
import { SplatEngine } from '../create-engine.ts';
import { DILATION_PX2, resolveAccuracy } from '../data/accuracy/accuracy.ts';
import { orthographicCamera } from '../data/camera/camera.ts';
import { GpuLimitError, InvalidArgumentError } from '../data/errors.ts';
import type { SplatSet } from '../data/splats/splat-set.ts';
import type { EngineOptions } from '../engine.ts';
import { screenAxes } from '../reference/covariance.ts';
import { cullSplat } from '../stages/cull/cull.reference.ts';
import { pixelCosts } from '../stages/tile-costs/tile-costs.reference.ts';
import { UNSEEN_PX } from '../stages/tile-costs/tile-costs.ts';
import { randomSplats, type SplatValues, splatsOf } from '../testing/random-splats.ts';
import { testGpu } from '../testing/test-gpu.ts';
import { countCosts, mapContributions } from './count-costs.ts';
import { InspectedFrame } from './inspected-frame.ts';

const SIZE = { widthPx: 20, heightPx: 12 };
const PIXELS = SIZE.widthPx * SIZE.heightPx;
/** A world unit of height; the picture's middle is the origin, seen from z = 5. */
const camera = orthographicCamera({
  position: [0, 0, 5],
  target: [0, 0, 0],
  aspect: SIZE.widthPx / SIZE.heightPx,
  height: 1,
});
const accuracy = resolveAccuracy('reference');

const gpu = testGpu();

async function withEngine(
  options: EngineOptions,
  use: (engine: SplatEngine) => Promise<void>,
): Promise<void> {
  const engine = await SplatEngine.create({ ...options, device: gpu.device });
  await use(engine);
  expect(engine.memory().frames.views).toEqual([]);
  engine.destroy();
}

/** Splats that fill the picture, at successive depths. */
const layers = (count: number, opacityLogit: number, from: number): SplatValues[] =>
  Array.from({ length: count }, (_, i) => ({
    position: [0, 0, from - 0.001 * i],
    logScales: [5, 5, 5],
    opacityLogit,
  }));

describe('counting the costs of a frame', () => {
  gpuTest('tells steps until pixels end, splats that they and quads blend, and lists', async () => {
    await withEngine({}, async (engine) => {
      // Ten opaque layers, of which four leave less than 2⁻¹⁶: (0.01)² > 2⁻¹⁶ > (0.01)³.
      const cloud = engine.add(splatsOf(layers(10, 20, 0)));
      for (const rasterizer of ['quads', 'tiles'] as const) {
        const costs = await countCosts(engine, {
          camera,
          clouds: [{ cloud }],
          ...SIZE,
          accuracy: { ...accuracy, rasterizer },
        });
        const all = (count: number, value: number) => Array.from({ length: count }, () => value);
        expect(costs).toMatchObject({ ...SIZE, tileColumns: 3, tilePx: 8 });
        expect([...costs.steps]).toEqual(all(PIXELS, 3));
        expect([...costs.blended]).toEqual(all(PIXELS, 3));
        expect([...costs.fragments]).toEqual(all(PIXELS, 10));
        expect([...costs.tileEntries]).toEqual(all(6, 10));
      }
    });
  });

  gpuTest('counts pixels of the layer where the resolution is scaled', async () => {
    await withEngine({}, async (engine) => {
      const cloud = engine.add(splatsOf(layers(2, 0, 0)));
      const request = {
        camera,
        clouds: [{ cloud }],
        ...SIZE,
        accuracy: { ...accuracy, resolutionScale: 0.5 },
      };
      const costs = await countCosts(engine, request);
      expect(costs).toMatchObject({ widthPx: 10, heightPx: 6, tileColumns: 2 });
      expect(costs.fragments.length).toBe(60);
    });
  });

  /** A frame of forty bins, and lines across all of them. */
  const wide = { camera, widthPx: 2560, heightPx: 8, accuracy };
  const lines = (count: number) =>
    splatsOf(layers(count, 0, 0).map((splat) => ({ ...splat, logScales: [5, -9, -9] })));

  gpuTest('draws again where the lists had no room', async () => {
    await withEngine({}, async (engine) => {
      // More pairs than are guessed for so few splats.
      const costs = await countCosts(engine, { ...wide, clouds: [{ cloud: engine.add(lines(500)) }] });
      expect(Math.max(...costs.tileEntries)).toBe(500);
    });
  });

  gpuTest('tells the size of lists that never have room', async () => {
    await withEngine({ tileBudgetBytes: 2e4 }, async (engine) => {
      const counting = countCosts(engine, { ...wide, clouds: [{ cloud: engine.add(lines(50)) }] });
      await expect(counting).rejects.toThrow(/tiles would need .* tileBudgetBytes/);
      await expect(counting).rejects.toBeInstanceOf(GpuLimitError);
    });
  });

  gpuTest('refuses a frame without pixels, and counts none without splats', async () => {
    await withEngine({}, async (engine) => {
      const request = { camera, clouds: [], ...SIZE, accuracy };
      await expect(countCosts(engine, { ...request, widthPx: 0 })).rejects.toThrow(InvalidArgumentError);
      expect(Math.max(...(await countCosts(engine, request)).tileEntries)).toBe(0);
      const { contributionsPx, opacity } = await mapContributions(engine, request);
      expect(contributionsPx.length).toBe(0);
      expect(Math.max(...opacity)).toBe(0);
    });
  });
});

describe('contributions of splats', () => {
  gpuTest('are their shares of all pixels, and tell which are not seen', async () => {
    await withEngine({}, async (engine) => {
      const hidden: SplatValues = { position: [0.1, 0.1, -1], logScales: [-5, -5, -5], opacityLogit: 20 };
      const cloud = engine.add(splatsOf([...layers(4, 20, 0), hidden]));
      const map = await mapContributions(engine, { camera, clouds: [{ cloud }], ...SIZE, accuracy });
      const sorted = map.contributionsPx.toSorted((a, b) => b - a);
      expect(sorted[0]).toBeCloseTo(0.99 * PIXELS, 2);
      expect(sorted[1]).toBeCloseTo(0.0099 * PIXELS, 3);
      expect(sorted[2]).toBeCloseTo(0.000099 * PIXELS, 3);
      // The fourth layer, and those behind it.
      expect([sorted[3], sorted[4]]).toEqual([0, 0]);
      expect(sorted.filter((px) => px < UNSEEN_PX).length).toBe(2);
      const places = [...map.unseen.keys()].filter((i) => map.unseen[i] > 0);
      expect(places).toEqual([(6 - 2) * SIZE.widthPx + 11, 6 * SIZE.widthPx + 10].sort((a, b) => a - b));
      const mean = [0, 1, 2].reduce((sum, i) => sum + sorted[i] * Math.log2(sorted[i]), 0) / PIXELS;
      for (const value of map.meanLog2) expect(value).toBeCloseTo(mean, 3);
      for (const value of map.opacity) expect(value).toBeCloseTo(1, 5);
    });
  });

  gpuTest('add up to the opacity of the picture', async () => {
    await withEngine({}, async (engine) => {
      const cloud = engine.add(randomSplats({ count: 600, shDegree: 0, halfExtent: 0.5 }));
      const { opacity, contributionsPx } = await mapContributions(engine, {
        camera,
        clouds: [{ cloud }],
        ...SIZE,
        accuracy,
      });
      const sum = (values: Float32Array) => values.reduce((total, value) => total + value, 0);
      expect(sum(opacity)).toBeGreaterThan(PIXELS / 2);
      expect(sum(contributionsPx) / sum(opacity)).toBeCloseTo(1, 4);
    });
  });
});

gpuTest('fragments and contributions are those that float64 finds in the whole scene', async () => {
  await withEngine({}, async (engine) => {
    const set = randomSplats({ count: 400, shDegree: 0, halfExtent: 0.5, logScales: [-4, -1.5] });
    const request = { camera, clouds: [{ cloud: engine.add(set) }], ...SIZE, accuracy };
    const costs = await countCosts(engine, request);
    const { contributionsPx } = await mapContributions(engine, request);
    const splats = await visibleByReference(set);
    expect(contributionsPx.length).toBe(splats.length);
    const nearestFirst = [...splats.keys()].sort((a, b) => splats[a].depthView - splats[b].depthView);
    const ranked = nearestFirst.map((i) => splats[i]);
    const expectedPx = splats.map(() => 0);
    let differing = 0;
    for (let at = 0; at < PIXELS; at++) {
      const pixel = [at % SIZE.widthPx, Math.floor(at / SIZE.widthPx)] as const;
      const { weights, blended, fragments } = pixelCosts(ranked, pixel, accuracy.alphaCutoff);
      for (const [rank, weight] of weights.entries()) expectedPx[nearestFirst[rank]] += weight;
      expect(costs.blended[at]).toBeLessThanOrEqual(costs.steps[at]);
      // Float32 may decide otherwise where a splat just reaches the cutoff.
      expect(Math.abs(costs.fragments[at] - fragments)).toBeLessThanOrEqual(1);
      differing += Number(costs.fragments[at] !== fragments || costs.blended[at] !== blended);
    }
    expect(differing).toBeLessThan(PIXELS / 50);
    for (const [i, expected] of expectedPx.entries())
      expect(Math.abs(contributionsPx[i] - expected), `splat ${i}`).toBeLessThan(0.005 + 1e-3 * expected);
  });
});

/** The splats that culling keeps, in storage order, in float64. */
async function visibleByReference(set: SplatSet) {
  const frame = await InspectedFrame.draw(gpu.device, { clouds: [{ set }], camera, keyBits: 8, ...SIZE });
  const [{ stored, view }] = frame.clouds;
  const settings = { alphaCutoff: accuracy.alphaCutoff, dilationPx2: DILATION_PX2, effects: [] };
  const culled = Array.from({ length: stored.count }, (_, i) =>
    cullSplat(stored, i, view, frame.projection, settings),
  );
  frame.destroy();
  return culled
    .filter((splat) => splat !== null)
    .map(({ centerPx, depthView, opacity, covariance }) => {
      const axes = screenAxes(covariance);
      return { centerPx, depthView, ...axes, color: [1, 1, 1, opacity] };
    });
}
