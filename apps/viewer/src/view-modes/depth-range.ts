import type { Sphere } from '../camera/scene-bounds.ts';

/** View depths, world units, above 0. */
export interface DepthRange {
  readonly near: number;
  readonly far: number;
}

/** The scene that the scale of depths is fitted to. */
export interface DepthSubject {
  /** Bounds of the scene as it is drawn, without stray splats. */
  readonly bounds: Sphere;
  /** From the camera to its target, world units. */
  readonly focusDistance: number;
}

/** Of far to near, so that neither rounding nor a division by next to nothing shows. */
const LEAST_RATIO = 1.001;

/**
 * The view depths that the scale reaches over: all of the scene, but from inside of it only what is
 * not much nearer than what the camera turns around, to which most of the scale would go else.
 *
 * @param v world to view, column-major.
 */
export function viewDepthsOf({ bounds, focusDistance }: DepthSubject, v: ArrayLike<number>): DepthRange {
  const [x, y, z] = bounds.center;
  const depth = -(v[2] * x + v[6] * y + v[10] * z + v[14]);
  const nearest = Math.max(depth - bounds.radius, focusDistance / 2);
  const far = depth + bounds.radius;
  // The scene is too far for float32 to tell depths, or behind the camera or before its target.
  if (!(far > LEAST_RATIO * nearest)) return { near: nearest, far: 2 * nearest };
  return { near: nearest, far };
}

/**
 * The depth at a part of the scale, 0…1 from near to far. Its steps are even in 1/depth, as sizes
 * on the screen are: near things are told apart from each other, however far the background is.
 */
export function depthAt({ near, far }: DepthRange, part: number): number {
  return 1 / ((1 - part) / near + part / far);
}
