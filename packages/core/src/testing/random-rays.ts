import { expect } from 'vitest';
import { makeRayTree } from '../clouds/rays/make-ray-tree.ts';
import type { RayTree } from '../clouds/rays/ray-tree.ts';
import { perspectiveCamera } from '../data/camera/camera.ts';
import type { Harmonics } from '../data/packing/harmonics.ts';
import { packCloud } from '../data/packing/packed-cloud.ts';
import type { SplatSet } from '../data/splats/splat-set.ts';
import { seededRandom } from './seeded-random.ts';
import { type TrueRay, trueRays } from './true-rays.ts';

type View = Omit<Parameters<typeof perspectiveCamera>[0], 'aspect'>;

/** 200 random pixels of each camera, with the reference's depth and cover there. */
export function randomRays(set: SplatSet<Harmonics>, cameras: readonly View[]): TrueRay[] {
  const [widthPx, heightPx] = [640, 480];
  const random = seededRandom(11);
  return cameras.flatMap((camera) => {
    const pixels = Array.from(
      { length: 200 },
      () => [Math.floor(random() * widthPx), Math.floor(random() * heightPx)] as const,
    );
    return trueRays(set, perspectiveCamera({ ...camera, aspect: 4 / 3 }), widthPx, heightPx, pixels);
  });
}

export const isBare = ({ opacity }: TrueRay) => opacity < 0.1;
export const isCovered = ({ opacity }: TrueRay) => opacity > 0.5;

/** Part of the rays at covered pixels that hit within 2 % of the depth of their heaviest splat. */
export function partWithin2Percent(tree: RayTree, rays: readonly TrueRay[]): number {
  const covered = rays.filter(isCovered);
  const right = covered.filter(({ origin, direction, depthView, options }) => {
    const hit = tree.cast(origin, direction, options);
    return hit !== null && Math.abs(hit.distance / depthView - 1) <= 0.02;
  });
  return right.length / covered.length;
}

/**
 * 1,000 rays from around an object about 0, 2 across. A ray through a covered pixel must hit within
 * 2 % of the pixel's depth; a ray through a pixel with an opacity below 0.1 must miss.
 */
export async function expectRaysAsShown(set: SplatSet<Harmonics>): Promise<void> {
  const cameras = [0, 1, 2, 3, 4].map((i) => ({
    position: [2.2 * Math.cos(1.3 * i), 0.6 * Math.sin(2 * i), 2.2 * Math.sin(1.3 * i)] as const,
    target: [0, 0, 0] as const,
    fovYDegrees: 50,
  }));
  const tree = await makeRayTree(packCloud(set, { geometryPrecision: 'packed' }), {});
  const rays = randomRays(set, cameras);
  expect(rays.filter(isCovered).length).toBeGreaterThan(100);
  expect(partWithin2Percent(tree, rays)).toBe(1);
  const bare = rays.filter(isBare);
  expect(bare.length).toBeGreaterThanOrEqual(100);
  const hit = bare.filter(({ origin, direction, options }) => tree.cast(origin, direction, options) !== null);
  expect(hit).toHaveLength(0);
}
