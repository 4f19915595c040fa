// Proves: a thousand rays hit the splats that float64 picks, and miss where nothing is.
import { stillLifeCameras } from '@websplatter/scenes';
import { beforeAll, describe, expect, test } from 'vitest';
import { filterSplats } from '../../data/editing/crop-splats.ts';
import type { Vec3 } from '../../data/math/mat4.ts';
import type { Harmonics } from '../../data/packing/harmonics.ts';
import { packCloud } from '../../data/packing/packed-cloud.ts';
import type { SplatSet } from '../../data/splats/splat-set.ts';
import { isBare, isCovered, partWithin2Percent, randomRays } from '../../testing/random-rays.ts';
import { everyOf, stillLife } from '../../testing/still-life.ts';
import type { TrueRay } from '../../testing/true-rays.ts';
import { makeRayTree } from './make-ray-tree.ts';
import type { RayTree } from './ray-tree.ts';

/** The splats within `radius` of `center`. */
function within(set: SplatSet<Harmonics>, center: Vec3, radius: number): SplatSet<Harmonics> {
  return filterSplats(set, (index) => {
    const offset = center.map((c, axis) => set.positions[3 * index + axis] - c);
    return Math.hypot(...offset) < radius;
  });
}

describe('1,000 random rays at a still life whose splats share blobs, against picks of the reference,', () => {
  let rays: TrueRay[];
  let tree: RayTree;
  beforeAll(async () => {
    // Without its surroundings, so that there is something to miss.
    const set = within(everyOf(await stillLife('still-life'), 2), [0, 0.3, 0], 0.8);
    const packed = packCloud(set, { geometryPrecision: 'packed' });
    tree = await makeRayTree(packed, { mostBlobs: Math.round(set.count / 4.6) });
    rays = randomRays(set, stillLifeCameras.slice(0, 5));
  });

  test('miss where fewer than 10 % is covered, and hit where more than half is', () => {
    const [bare, covered] = [rays.filter(isBare), rays.filter(isCovered)];
    expect(bare.length).toBeGreaterThan(100);
    expect(covered.length).toBeGreaterThan(300);
    const hit = ({ origin, direction, options }: TrueRay) => tree.cast(origin, direction, options) !== null;
    const right = [...bare.filter((ray) => !hit(ray)), ...covered.filter(hit)];
    expect(right.length / (bare.length + covered.length)).toBeGreaterThan(0.97);
  });

  test('hit within 2 % of the depth, nine in ten', () => {
    expect(partWithin2Percent(tree, rays)).toBeGreaterThan(0.9);
  });

  test('tell which labels are hidden', () => {
    // A label a tenth of its distance before or behind what is seen.
    const isRight = ({ origin, direction, opacity, depthView, options }: TrueRay, side: number) => {
      const isHidden = opacity > 0.5 && side > 1;
      const label = (opacity > 0.5 ? depthView : 1) * side;
      const hit = tree.cast(origin, direction, options);
      return (hit !== null && hit.distance < label) === isHidden;
    };
    const clear = rays.filter((ray) => isBare(ray) || isCovered(ray));
    const right = [0.9, 1.1].flatMap((side) => clear.filter((ray) => isRight(ray, side)));
    expect(right.length / (2 * clear.length)).toBeGreaterThan(0.98);
  });
});
