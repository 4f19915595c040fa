import fc from 'fast-check';
import { describe, expect, test } from 'vitest';
import type { SplatCloud } from '../../clouds/splat-cloud.ts';
import { DILATION_PX2 } from '../../data/accuracy/accuracy.ts';
import { type Camera, perspectiveCamera, projectionOf } from '../../data/camera/camera.ts';
import { cloudView } from '../../data/camera/cloud-view.ts';
import { frustumSides } from '../../data/camera/frustum.ts';
import { identity4 } from '../../data/math/mat4.ts';
import { packCloud } from '../../data/packing/packed-cloud.ts';
import type { SplatSet } from '../../data/splats/splat-set.ts';
import { cullSplat } from '../../stages/cull/cull.reference.ts';
import { anyCamera } from '../../testing/any-view.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { TEST_MODELS } from '../../testing/test-cameras.ts';
import { RecentNeeds } from './frame-planner.ts';
import { mostDrawnSplats, mostVisibleSplats, visibleCapacity } from './visible-capacity.ts';

const ALPHA_CUTOFF = 1 / 255;
const SIZE = { widthPx: 64, heightPx: 48 };
const CAMERA = perspectiveCamera({ position: [0, 0, 0], target: [0, 0, 1], fovYDegrees: 50, aspect: 1.3 });

/** More splats than always have room; small ones, so that most chunks are clearly in or out. */
const set = randomSplats({ count: 270_000, shDegree: 0, logScales: [-9, -7] });
const cloud = packed(set);

function packed(splats: SplatSet, visibleLimit = Number.POSITIVE_INFINITY): SplatCloud {
  const own = packCloud(splats, { geometryPrecision: 'packed' });
  return { ...own, visibleLimit, features: [] } as unknown as SplatCloud;
}

const cloudsOf = (camera: Camera, modelMatrix: ArrayLike<number> = identity4()) => {
  const projection = projectionOf(camera, SIZE.widthPx, SIZE.heightPx);
  const view = cloudView(camera.viewMatrix, modelMatrix, set.origin, projection.isOrthographic);
  return [{ instance: { cloud }, sides: frustumSides(view, projection, ALPHA_CUTOFF, DILATION_PX2) }];
};

describe('mostVisibleSplats', () => {
  test('suffices for all splats that are drawn', { tags: 'deeper' }, () => {
    fc.assert(
      fc.property(anyCamera, fc.constantFrom(...Object.values(TEST_MODELS)), (camera, modelMatrix) => {
        const projection = projectionOf(camera, SIZE.widthPx, SIZE.heightPx);
        const view = cloudView(camera.viewMatrix, modelMatrix, set.origin, projection.isOrthographic);
        let drawn = 0;
        for (let i = 0; i < set.count; i++) {
          const settings = { alphaCutoff: ALPHA_CUTOFF, dilationPx2: DILATION_PX2 };
          if (cullSplat(set, i, view, projection, settings)) drawn++;
        }
        expect(mostVisibleSplats(cloudsOf(camera, modelMatrix))).toBeGreaterThanOrEqual(drawn);
      }),
      // Tests of frustums show the same of every chunk, for many cameras.
      { numRuns: process.env.WEBSPLATTER_FULL ? 5 : 1, seed: 1 },
    );
  });

  test('is less than all splats if few are in sight, and never more than all', () => {
    expect(mostVisibleSplats(cloudsOf(CAMERA))).toBeLessThan(set.count / 2);
    const away = perspectiveCamera({ position: [0, 0, 9], target: [0, 0, 0], fovYDegrees: 50, aspect: 1 });
    expect(mostVisibleSplats(cloudsOf(away))).toBe(set.count);
  });

  test('is a budget, with blobs of each cloud at their coarsest, and all of clouds without a cut', () => {
    const [drawn] = cloudsOf(CAMERA);
    const cut = { camera: [0, 0, 0], squaredPerDistance: 1, leastSquared: 0, margin: 0 } as const;
    const budget = { splats: 5000, leastShift: 0 };
    expect(mostVisibleSplats([{ ...drawn, cut }], budget)).toBe(5000 + 256);
    // What is edited or selected is drawn besides.
    expect(mostVisibleSplats([{ ...drawn, cut, isTouched: true }], budget)).toBe(set.count);
    const both = [{ ...drawn, cut }, drawn];
    expect(mostVisibleSplats(both, { ...budget, splats: 300_000 })).toBeLessThanOrEqual(
      300_000 + 256 + set.count,
    );
    expect(mostDrawnSplats(both, budget)).toBe(5000 + 256 + set.count);
  });

  test('is that of the places of a cut in which anything is in sight', () => {
    const cut = { camera: [0, 0, 0], squaredPerDistance: 1, leastSquared: 0, margin: 0 } as const;
    const away = perspectiveCamera({ position: [0, 0, 9], target: [0, 0, 0], fovYDegrees: 50, aspect: 1 });
    const at = (z: number) => [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, z, 1];
    const placed = (matrices: number[][]) => ({
      ...cloudsOf(away)[0],
      cut,
      instance: { cloud, instances: { modelMatrices: matrices.flat() } },
      places: matrices.map((matrix) => ({ ...cloudsOf(away, matrix)[0], cut })),
    });
    const places = [at(0), at(60), at(-20), at(40)] as const;
    const seen = placed([...places]) as unknown as Parameters<typeof mostVisibleSplats>[0][number];
    expect(mostVisibleSplats([seen])).toBe(2 * set.count);
    expect(mostVisibleSplats([{ ...seen, isTouched: true }], { splats: 10, leastShift: 0 })).toBe(
      2 * set.count,
    );
    expect(mostVisibleSplats([seen], { splats: 300_000, leastShift: 0 })).toBe(300_000 + 4 * 256);
  });

  test('is all splats for small scenes', () => {
    const small = packed(randomSplats({ count: 1000, shDegree: 0 }));
    const [planned] = cloudsOf(CAMERA);
    expect(mostVisibleSplats([{ ...planned, instance: { cloud: small } }])).toBe(1000);
    expect(mostVisibleSplats([])).toBe(0);
  });

  test('is at most the limit of a cloud that is drawn alone', () => {
    const limited = packed(randomSplats({ count: 1000, shDegree: 0 }), 300);
    const [planned] = cloudsOf(CAMERA);
    const inLimit = { ...planned, instance: { cloud: limited } };
    expect(mostDrawnSplats([inLimit])).toBe(300);
    expect(mostVisibleSplats([inLimit])).toBe(300);
    expect(mostDrawnSplats([planned, inLimit])).toBe(set.count + 1000);
  });
});

describe('visibleCapacity', () => {
  const TOTAL = 1_000_000;

  test('has spare room in whole chunks, and never more than for all splats', () => {
    const capacity = visibleCapacity(100_000, TOTAL, 0, 0);
    expect(capacity).toBeGreaterThan(110_000);
    expect(capacity).toBeLessThan(140_000);
    expect(capacity % 256).toBe(0);
    expect(visibleCapacity(950_000, TOTAL, 0, 0)).toBe(TOTAL);
    expect(visibleCapacity(0, 0, 0, 0)).toBe(0);
  });

  test('is kept while it suffices, and grows at once if it does not', () => {
    expect(visibleCapacity(100_000, TOTAL, 100_000, 100_000)).toBe(100_000);
    expect(visibleCapacity(60_000, TOTAL, 100_000, 60_000)).toBe(100_000);
    expect(visibleCapacity(100_001, TOTAL, 100_000, 90_000)).toBeGreaterThan(120_000);
    expect(visibleCapacity(TOTAL, TOTAL, TOTAL, TOTAL)).toBe(TOTAL);
  });

  test('shrinks only after no recent frame needed much of it', () => {
    expect(visibleCapacity(10_000, TOTAL, 100_000, 90_000)).toBe(100_000);
    expect(visibleCapacity(10_000, TOTAL, 100_000, 10_000)).toBeLessThan(15_000);
    expect(visibleCapacity(10_000, TOTAL, 100_000, 30_000)).toBeGreaterThan(30_000);
  });

  test('suffices, and settles: with the same needs, the next frame changes nothing', () => {
    const splats = fc.nat(TOTAL);
    fc.assert(
      fc.property(splats, splats, splats, (needed, current, peak) => {
        const recent = Math.max(peak, needed);
        const capacity = visibleCapacity(needed, TOTAL, current, recent);
        expect(capacity).toBeGreaterThanOrEqual(needed);
        expect(capacity).toBeLessThanOrEqual(TOTAL);
        expect(visibleCapacity(needed, TOTAL, capacity, recent)).toBe(capacity);
      }),
    );
  });

  /** Changes of capacity in each of six rounds, from the edge, looking out, to most in sight. */
  function changesByRound(roundMs: number): number[] {
    const framesPerRound = 200;
    const recent = new RecentNeeds();
    const changes = [0, 0, 0, 0, 0, 0];
    let capacity = 0;
    for (let frame = 0; frame < changes.length * framesPerRound; frame++) {
      const angle = (2 * Math.PI * frame) / framesPerRound;
      const position = [0.3 * Math.sin(angle), 0, -0.3 - 0.5 * Math.cos(angle)] as const;
      const camera = perspectiveCamera({ position, target: [0, 0, 2], fovYDegrees: 50, aspect: 1.3 });
      const needed = mostVisibleSplats(cloudsOf(camera));
      const next = visibleCapacity(needed, set.count, capacity, recent.value.visibleSplats);
      if (next !== capacity) changes[Math.floor(frame / framesPerRound)]++;
      capacity = next;
      recent.take({ visibleSplats: needed, depthBits: 24 }, (frame * roundMs) / framesPerRound);
    }
    return changes;
  }

  test('changes a few times in the first round of an orbit, and never after that, however slow it is', () => {
    for (const roundMs of [5000, 17_000, 60_000, 120_000]) {
      const [first, ...later] = changesByRound(roundMs);
      expect(first, `rounds of ${roundMs} ms`).toBeLessThan(8);
      expect(later, `rounds of ${roundMs} ms`).toEqual([0, 0, 0, 0, 0]);
    }
  });
});
