import { clipPoint, type PicturePoint, type PictureSpace, rowOf } from '../camera/picture-space.ts';
import type { Vec3 } from '../state/vec3.ts';

/** An axis projected into the image: a point and a direction. */
export interface SeenAxis {
  readonly from: PicturePoint;
  readonly to: PicturePoint;
  /** Whether it is long enough to drag: neither end on nor behind the camera. */
  readonly canDrag: boolean;
}

/** Axes shorter than this fraction of their full length give no direction to drag in. */
const LEAST_PART = 1 / 6;

/** Image coordinates times depth, and depth: linear in the point, so lines stay lines. */
type Homogeneous = readonly [x: number, y: number, w: number];

/**
 * Projects an axis of the scene at `point`, `lengthPx` long if it is perpendicular to the view.
 * Null if the point is behind the camera.
 *
 * @param axis a unit vector in the camera's world space.
 */
export function seenAxis(space: PictureSpace, point: Vec3, axis: Vec3, lengthPx: number): SeenAxis | null {
  const middle = homogeneous(space, point, 1);
  if (!(middle[2] > 0)) return null;
  const from = place(middle);
  const across = homogeneous(space, rowOf(space.camera.viewMatrix, 0), 0);
  const length = (lengthPx * middle[2]) / Math.hypot(across[0], across[1]);
  const end = along(middle, homogeneous(space, axis, 0), length);
  const to = end[2] > 0 ? place(end) : from;
  const canDrag = Math.hypot(to[0] - from[0], to[1] - from[1]) >= LEAST_PART * lengthPx;
  return { from, to, canDrag };
}

/**
 * Distance along `axis` from `point` to the place that appears nearest to `at`; exact in
 * perspective too. Null if the axis is seen end on.
 */
export function distanceAlong(space: PictureSpace, point: Vec3, axis: Vec3, at: PicturePoint): number | null {
  const middle = homogeneous(space, point, 1);
  const direction = homogeneous(space, axis, 0);
  const from = place(middle);
  // The image of the axis is a line; its positions are quotients of linear functions of distance.
  const [ux, uy] = [direction[0] - from[0] * direction[2], direction[1] - from[1] * direction[2]];
  const wanted = ux * at[0] + uy * at[1];
  const below = ux * direction[0] + uy * direction[1] - wanted * direction[2];
  const distance = (wanted * middle[2] - (ux * middle[0] + uy * middle[1])) / below;
  const isSeen = middle[2] + distance * direction[2] > 0;
  return isSeen && Number.isFinite(distance) ? distance : null;
}

/** @param w 1 for a point, 0 for a direction. */
function homogeneous(space: PictureSpace, point: Vec3, w: 0 | 1): Homogeneous {
  const [x, y, , clipW] = clipPoint(space, point, w);
  return [(space.width * (clipW + x)) / 2, (space.height * (clipW - y)) / 2, clipW];
}

function along(a: Homogeneous, b: Homogeneous, by: number): Homogeneous {
  return [a[0] + by * b[0], a[1] + by * b[1], a[2] + by * b[2]];
}

function place([x, y, w]: Homogeneous): PicturePoint {
  return [x / w, y / w];
}
