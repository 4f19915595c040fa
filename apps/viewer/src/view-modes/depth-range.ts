import type { Sphere } from '../camera/scene-bounds.ts';

/** View depths, world units, above 0. */
export interface DepthRange {
  readonly near: number;
  readonly far: number;
}

/** The scene that the depth scale is fitted to. */
export interface DepthSubject {
  /** Bounds of the scene as it is drawn, without stray splats. */
  readonly bounds: Sphere;
  /** Distance from the camera to its target, world units. */
  readonly focusDistance: number;
}

/** Least ratio of far to near, so that rounding and divisions by almost zero stay invisible. */
const LEAST_RATIO = 1.001;

/**
 * View depths at the ends of the scale. The scale covers the whole scene. If the camera is inside,
 * it starts at half the distance to the camera's target: nearer splats would take most of it.
 *
 * @param v world to view, column-major.
 */
export function viewDepthsOf({ bounds, focusDistance }: DepthSubject, v: ArrayLike<number>): DepthRange {
  const [x, y, z] = bounds.center;
  const depth = -(v[2] * x + v[6] * y + v[10] * z + v[14]);
  const nearest = Math.max(depth - bounds.radius, focusDistance / 2);
  const far = depth + bounds.radius;
  // The scene is too far for float32 depths, behind the camera, or in front of its target.
  if (!(far > LEAST_RATIO * nearest)) return { near: nearest, far: 2 * nearest };
  return { near: nearest, far };
}

/**
 * The depth at position `part` of the scale, 0…1 from near to far. Steps are even in 1/depth, as
 * sizes on the screen are: near depths stay distinguishable, however far the background is.
 */
export function depthAt({ near, far }: DepthRange, part: number): number {
  return 1 / ((1 - part) / near + part / far);
}
