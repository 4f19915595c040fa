import type { FrustumSide } from '../../data/camera/frustum.ts';
import type { Bounds } from '../../data/packing/packed-cloud.ts';

/**
 * Factor on the value of parts out of sight: they are kept only if no part in sight needs their
 * room.
 */
export const OUT_OF_SIGHT = 1e-12;
/** Least squared threshold, so that errors can be divided by it. */
export const LEAST_SQUARED = 1e-36;
/** Slack of tests in float32, as in chunk-groups. */
const SLACK = 1e-4;

/** The state of one view of a streamed cloud: its cut, budget and frustum. */
export interface CloudSight {
  /** The view's cut through the levels: see `LevelCut`. */
  readonly cut: {
    readonly camera: readonly [number, number, number];
    readonly squaredPerDistance: number;
    readonly leastSquared: number;
    readonly margin: number;
  };
  /**
   * Factor by which the budget has scaled squared thresholds; 0 if no error is allowed, null before
   * a frame within the budget has been drawn.
   */
  readonly squaredShift: number | null;
  /**
   * The view's limit of drawn splats, and whether it allows no error below the limit. Null or
   * absent if the cut alone decides.
   */
  readonly budget?: { readonly splats: number; readonly isFinest: boolean } | null;
  /** Frustum planes, relative to the scene's origin. */
  readonly sides: readonly FrustumSide[];
}

/** Same formula as the shader cut-cells. */
export function squaredThreshold(
  { min, max }: Bounds,
  { camera, squaredPerDistance, leastSquared, margin }: CloudSight['cut'],
): number {
  let distance2 = 0;
  for (let axis = 0; axis < 3; axis++) {
    const apart = Math.max(min[axis] - camera[axis], camera[axis] - max[axis]) - margin;
    if (apart > 0) distance2 += apart * apart;
  }
  return Math.max(distance2 * squaredPerDistance, leastSquared);
}

/** Whether splats within these bounds may reach across a frustum plane to its inner side. */
export function reachesIn(
  { normal, offset, reach }: FrustumSide,
  { min, max }: Bounds,
  largestScale: number,
): boolean {
  let nearest = offset + reach * largestScale;
  let size = Math.abs(nearest);
  for (let axis = 0; axis < 3; axis++) {
    const part = normal[axis] * (normal[axis] > 0 ? max[axis] : min[axis]);
    nearest += part;
    size += Math.abs(part);
  }
  return nearest >= -SLACK * size;
}
