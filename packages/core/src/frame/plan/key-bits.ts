import type { Camera } from '../../data/camera/camera.ts';
import { orderedBits, orderedWords, sortDistance } from '../../data/layout/depth-key.ts';
import type { CloudPlan } from './cloud-plan.ts';

type SeenCloud = Pick<CloudPlan, 'instance' | 'view' | 'reach'> & Partial<Pick<CloudPlan, 'places'>>;

/** Bounds of the depths or distances of a frame's visible splats, world units. */
interface SeenRange {
  readonly nearest: number;
  readonly farthest: number;
  /** How far float32 may have moved a splat across the near or the far plane. */
  readonly rounding: number;
}

/**
 * Bounds the number of bits in which the sort keys of a frame can differ, from near, far and the
 * clouds' bounds, which the CPU knows. Depths within a factor of 2^k of each other differ in fewer
 * than 23 + k bits (each power of two holds 2^23 floats), and squares of distances in one more, so
 * most scenes need fewer passes than 32 bits would.
 *
 * @param isByDistance whether splats are sorted by distance, with perspective.
 * @returns 16, 24, 27 or 32: the key widths that sorts are made for.
 */
export function keyBitsFor(
  camera: Pick<Camera, 'near' | 'far'>,
  clouds: readonly SeenCloud[],
  isByDistance: boolean,
): number {
  const seen = seenRange(clouds, isByDistance);
  const nearest = Math.max(seen.nearest, camera.near);
  const farthest = isByDistance ? seen.farthest : Math.min(seen.farthest, camera.far);
  if (!(farthest > nearest)) return 16;
  const bitsOf = (depth: number) => orderedBits(isByDistance ? sortDistance(depth, camera.near) : depth);
  const range = bitsOf(farthest) - bitsOf(nearest);
  return [16, 24, 27].find((bits) => range < 2 ** bits) ?? 32;
}

/** Range of a frame's wide sort keys. */
interface WideKeyRange {
  /** Number of bits in which keys can differ: 56 or 64, the widths that sorts exist for. */
  readonly bits: number;
  /** See `wideKey`. */
  readonly farthestHigh: number;
}

/**
 * Bounds the wide sort keys of a frame, as `keyBitsFor` does. Upper words of depths within a factor
 * of 2^16 of each other differ in 24 bits: each power of two holds 2^20 of them.
 */
export function wideKeysFor(
  camera: Pick<Camera, 'near' | 'far'>,
  clouds: readonly SeenCloud[],
  isByDistance: boolean,
): WideKeyRange {
  const seen = seenRange(clouds, isByDistance);
  // Near and far are tested in float32, which may keep a splat that lies beyond them.
  const nearest = Math.max(seen.nearest, camera.near - seen.rounding);
  const farthest = isByDistance ? seen.farthest : Math.min(seen.farthest, camera.far + seen.rounding);
  const highOf = (depth: number) => orderedWords(isByDistance ? Math.max(0, depth) ** 2 : depth).high;
  const farthestHigh = highOf(Math.max(nearest, farthest));
  return { bits: farthestHigh - highOf(nearest) < 2 ** 24 ? 56 : 64, farthestHigh };
}

/** Without near and far; the nearest is above the farthest where there are no splats. */
function seenRange(clouds: readonly SeenCloud[], isByDistance: boolean): SeenRange {
  let most = 0;
  let farthest = Number.NEGATIVE_INFINITY;
  let nearest = Number.POSITIVE_INFINITY;
  const seen = clouds.flatMap(({ instance, reach, view, places }) =>
    (places ?? [{ view }]).map((place) => ({ cloud: instance.cloud, reach, view: place.view })),
  );
  for (const { cloud, reach, view } of seen) {
    const { count, origin, bounds } = cloud;
    const { linear, translation } = view;
    // A cloud without splats has no bounds.
    if (count === 0) continue;
    let low = 0;
    let high = 0;
    let farthestCorner = 0;
    // Depth needs the last of the view coordinates alone.
    for (let row = isByDistance ? 0 : 2; row < 3; row++) {
      low = -translation[row];
      high = low;
      let magnitude = Math.abs(low);
      for (let axis = 0; axis < 3; axis++) {
        const weight = -linear[3 * axis + row];
        const from = bounds.min[axis] - origin[axis];
        const to = bounds.max[axis] - origin[axis];
        low += Math.min(weight * from, weight * to);
        high += Math.max(weight * from, weight * to);
        magnitude += Math.abs(weight) * Math.max(Math.abs(from), Math.abs(to));
      }
      const moved =
        reach.displacement && reach.displacement * Math.hypot(linear[row], linear[row + 3], linear[row + 6]);
      // The GPU's coordinates are float32, computed from float32 terms about the cloud's origin.
      const rounding = 1e-5 * magnitude;
      low -= moved + rounding;
      high += moved + rounding;
      most = Math.max(most, rounding);
      if (isByDistance) farthestCorner = Math.hypot(farthestCorner, Math.max(-low, high));
    }
    // No distance is less than the depth.
    nearest = Math.min(nearest, low);
    farthest = Math.max(farthest, isByDistance ? farthestCorner : high);
  }
  return { nearest, farthest, rounding: most };
}
