import type { Camera } from '@websplatter/core';
import { add, scale, type Vec3 } from '../state/vec3.ts';

/** A camera, and the size of its picture in CSS pixels. */
export interface PictureSpace {
  readonly camera: Pick<Camera, 'viewMatrix' | 'projectionMatrix'>;
  readonly width: number;
  readonly height: number;
}

/** CSS pixels from the picture's top left. */
export type PicturePoint = readonly [x: number, y: number];

/** Lines of the world, each a list of points. */
export type Outline = readonly (readonly Vec3[])[];

/** Homogeneous coordinates of a point as the camera projects it. */
type ClipPoint = readonly [x: number, y: number, z: number, w: number];

/** Position of a world point in the picture; null if it is not in front of the camera. */
export function pictureOf(space: PictureSpace, point: Vec3): PicturePoint | null {
  const projected = clipPoint(space, point);
  return isInFront(projected) ? onPicture(space, projected) : null;
}

/** The part of a world line in front of the camera; null if no part is. */
export function lineInPicture(
  space: PictureSpace,
  from: Vec3,
  to: Vec3,
): readonly [PicturePoint, PicturePoint] | null {
  const [a, b] = [clipPoint(space, from), clipPoint(space, to)];
  if (!isInFront(a) && !isInFront(b)) return null;
  return [onPicture(space, cutToFront(a, b)), onPicture(space, cutToFront(b, a))];
}

/** World lines as an SVG path in the picture. */
export function pathInPicture(space: PictureSpace, lines: Outline): string {
  const parts = lines.flatMap((points) =>
    points.slice(1).map((point, i) => {
      const line = lineInPicture(space, points[i], point);
      return line ? `M${line.map(([x, y]) => `${x.toFixed(1)} ${y.toFixed(1)}`).join('L')}` : '';
    }),
  );
  return parts.join('');
}

/** Moves `point` by CSS pixels right and down in the picture, at the same depth. */
export function movedInPicture(space: PictureSpace, point: Vec3, rightPx: number, downPx: number): Vec3 {
  const { viewMatrix, projectionMatrix } = space.camera;
  const [, , , w] = clipPoint(space, point);
  const right = (2 * rightPx * w) / (space.width * projectionMatrix[0]);
  const up = (-2 * downPx * w) / (space.height * projectionMatrix[5]);
  return add(point, add(scale(rowOf(viewMatrix, 0), right), scale(rowOf(viewMatrix, 1), up)));
}

/** Moves `point` away from the camera by the world length of `awayPx` CSS pixels at its depth. */
export function movedAway(space: PictureSpace, point: Vec3, awayPx: number): Vec3 {
  const sideways = movedInPicture(space, point, awayPx, 0);
  const distance = Math.sign(awayPx) * Math.hypot(...sideways.map((value, axis) => value - point[axis]));
  return add(point, scale(rowOf(space.camera.viewMatrix, 2), -distance));
}

/**
 * Directions shorter than this in the picture point along the view: moving up moves along them. CSS
 * pixels.
 */
const SHORTEST_PX = 8;

/**
 * Moves `point` along `direction`, of length 1, as far as the pointer moves by these CSS pixels.
 */
export function movedAlong(
  space: PictureSpace,
  point: Vec3,
  direction: Vec3,
  rightPx: number,
  downPx: number,
): Vec3 {
  // Measured over a hundred pixels at the point's depth.
  const reference = 100;
  const sideways = movedInPicture(space, point, reference, 0);
  const length = Math.hypot(...sideways.map((value, axis) => value - point[axis]));
  const from = pictureOf(space, point);
  const to = pictureOf(space, add(point, scale(direction, length)));
  const [x, y] = from && to ? [to[0] - from[0], to[1] - from[1]] : [0, 0];
  const seenPx = Math.hypot(x, y);
  const part = seenPx < SHORTEST_PX ? -downPx / reference : (rightPx * x + downPx * y) / (seenPx * seenPx);
  return add(point, scale(direction, part * length));
}

/** @param w 1 for a point, 0 for a direction. */
export function clipPoint({ camera }: PictureSpace, [x, y, z]: Vec3, w = 1): ClipPoint {
  return transformed(camera.projectionMatrix, transformed(camera.viewMatrix, [x, y, z, w]));
}

function transformed(m: ArrayLike<number>, [x, y, z, w]: ClipPoint): ClipPoint {
  const row = (i: number) => m[i] * x + m[4 + i] * y + m[8 + i] * z + m[12 + i] * w;
  return [row(0), row(1), row(2), row(3)];
}

function isInFront(point: ClipPoint): boolean {
  return point[3] > 0 && beyondNear(point) >= 0;
}

/** Positive beyond the near plane, which is at depth −1 of the cameras' clip space. */
function beyondNear([, , z, w]: ClipPoint): number {
  return z + w;
}

/** `a`, or the point where the line from `a` to `b` crosses the near plane. */
function cutToFront(a: ClipPoint, b: ClipPoint): ClipPoint {
  if (isInFront(a)) return a;
  const part = beyondNear(a) / (beyondNear(a) - beyondNear(b));
  return a.map((value, i) => value + part * (b[i] - value)) as unknown as ClipPoint;
}

function onPicture({ width, height }: PictureSpace, [x, y, , w]: ClipPoint): PicturePoint {
  return [((x / w + 1) / 2) * width, ((1 - y / w) / 2) * height];
}

/** Direction of a camera axis in the world: 0 right, 1 up, 2 back. */
export function rowOf(viewMatrix: ArrayLike<number>, row: number): Vec3 {
  return [viewMatrix[row], viewMatrix[4 + row], viewMatrix[8 + row]];
}

/** Number of lines with which a circle looks round. */
const CIRCLE_LINES = 96;

/** A circle spanned by two perpendicular directions of length 1. */
export function circleOutline(center: Vec3, u: Vec3, v: Vec3, radius: number): readonly Vec3[] {
  return Array.from({ length: CIRCLE_LINES + 1 }, (_, i) => {
    const angle = (2 * Math.PI * i) / CIRCLE_LINES;
    return add(center, add(scale(u, radius * Math.cos(angle)), scale(v, radius * Math.sin(angle))));
  });
}

/** The twelve edges of a box. */
export function boxOutline(min: Vec3, max: Vec3): Outline {
  const level = (y: number): Vec3[] => [
    [min[0], y, min[2]],
    [max[0], y, min[2]],
    [max[0], y, max[2]],
    [min[0], y, max[2]],
    [min[0], y, min[2]],
  ];
  const [below, above] = [level(min[1]), level(max[1])];
  return [below, above, ...below.slice(1).map((point, i) => [point, above[i + 1]])];
}
