import { type WideKey, wideKey } from '../../data/layout/depth-key.ts';
import type { Vec3 } from '../../data/math/mat4.ts';

/**
 * The number that splats are sorted by in float64: the depth, or the square of the distance from the
 * camera. Its operations and their order belong to its meaning: they decide between depths that are
 * equal but for rounding, here as on the GPU.
 *
 * @param centerView the splat's centre in view space, each coordinate ((a·x + b·y) + c·z) + d for a
 *   row a, b, c, d of model and view together, about the cloud's origin.
 */
export function sortDepth([x, y, z]: Vec3, isByDistance: boolean): number {
  return isByDistance ? x * x + y * y + z * z : -z;
}

/** Reference of wide-keys: the key of one splat. */
export function wideSortKey(centerView: Vec3, isByDistance: boolean, farthestHigh: number): WideKey {
  return wideKey(sortDepth(centerView, isByDistance), farthestHigh);
}

/** Reference of sort-gather: the upper words of keys, in the order that `payloads` lists. */
export function sortGather(upperKeys: ArrayLike<number>, payloads: Uint32Array): Uint32Array {
  return payloads.map((index) => upperKeys[index]);
}
