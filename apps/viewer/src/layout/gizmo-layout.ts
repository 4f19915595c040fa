import type { Camera } from '@websplatter/core';
import type { Vec3 } from '../camera/vec3.ts';

/** A place in the image, from its top left, CSS pixels. */
export interface ImagePlace {
  readonly x: number;
  readonly y: number;
}

/** Size of the image, CSS pixels. */
export interface ImageSize {
  readonly width: number;
  readonly height: number;
}

/** An axis as it is seen: from a point in the scene along a direction. */
export interface SeenAxis {
  readonly from: ImagePlace;
  readonly to: ImagePlace;
  /** Whether it is long enough in the image to drag: not seen end on, nor behind the camera. */
  readonly canDrag: boolean;
}

/** Axes that are shorter in the image have no direction to drag in. */
const LEAST_LENGTH_PX = 14;

/** Image coordinates times depth, and depth: linear in the point, so that lines stay lines. */
type Homogeneous = readonly [x: number, y: number, w: number];

/**
 * The axes of the scene at `point` as a camera sees them, `lengthPx` long where they lie across the
 * view; null where the point is behind the camera.
 *
 * @param axes unit vectors, in the world that the camera sees.
 */
export function seenAxes(
  camera: Pick<Camera, 'viewMatrix' | 'projectionMatrix'>,
  size: ImageSize,
  point: Vec3,
  axes: readonly Vec3[],
  lengthPx: number,
): readonly SeenAxis[] | null {
  const middle = homogeneous(camera, size, point, 1);
  if (!(middle[2] > 0)) return null;
  const from = place(middle);
  const { viewMatrix } = camera;
  const right: Vec3 = [viewMatrix[0], viewMatrix[4], viewMatrix[8]];
  const across = homogeneous(camera, size, right, 0);
  const length = (lengthPx * middle[2]) / Math.hypot(across[0], across[1]);
  return axes.map((axis) => {
    const to = along(middle, homogeneous(camera, size, axis, 0), length);
    const seen = to[2] > 0 ? place(to) : from;
    const canDrag = Math.hypot(seen.x - from.x, seen.y - from.y) >= LEAST_LENGTH_PX;
    return { from, to: seen, canDrag };
  });
}

/**
 * How far along `axis` from `point` something is that is seen as near as possible to `at`, in the
 * axis's lengths; exact in perspective too. Null where the axis is seen end on.
 */
export function distanceAlong(
  camera: Pick<Camera, 'viewMatrix' | 'projectionMatrix'>,
  size: ImageSize,
  point: Vec3,
  axis: Vec3,
  at: ImagePlace,
): number | null {
  const middle = homogeneous(camera, size, point, 1);
  const direction = homogeneous(camera, size, axis, 0);
  const from = place(middle);
  // In the image the axis is a line, with places at quotients of linear functions of distance.
  const [ux, uy] = [direction[0] - from.x * direction[2], direction[1] - from.y * direction[2]];
  const wanted = ux * at.x + uy * at.y;
  const below = ux * direction[0] + uy * direction[1] - wanted * direction[2];
  const distance = (wanted * middle[2] - (ux * middle[0] + uy * middle[1])) / below;
  const isSeen = middle[2] + distance * direction[2] > 0;
  return isSeen && Number.isFinite(distance) ? distance : null;
}

/** @param w 1 for a point, 0 for a direction. */
function homogeneous(
  { viewMatrix, projectionMatrix }: Pick<Camera, 'viewMatrix' | 'projectionMatrix'>,
  { width, height }: ImageSize,
  [x, y, z]: Vec3,
  w: 0 | 1,
): Homogeneous {
  const [clipX, clipY, , clipW] = times(projectionMatrix, times(viewMatrix, [x, y, z, w]));
  return [(width * (clipW + clipX)) / 2, (height * (clipW - clipY)) / 2, clipW];
}

function times(m: ArrayLike<number>, v: readonly number[]): number[] {
  return [0, 1, 2, 3].map((i) => m[i] * v[0] + m[4 + i] * v[1] + m[8 + i] * v[2] + m[12 + i] * v[3]);
}

function along(a: Homogeneous, b: Homogeneous, by: number): Homogeneous {
  return [a[0] + by * b[0], a[1] + by * b[1], a[2] + by * b[2]];
}

function place([x, y, w]: Homogeneous): ImagePlace {
  return { x: x / w, y: y / w };
}
