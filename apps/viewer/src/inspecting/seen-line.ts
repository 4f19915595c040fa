import type { Camera } from '@websplatter/core';
import { transformedPoint } from '../camera/scene-bounds.ts';
import { add, scale, subtract, type Vec3 } from '../camera/vec3.ts';

/** Place in the image, CSS px from its top left. */
export type Place = readonly [x: number, y: number];

export interface ImageBox {
  readonly width: number;
  readonly height: number;
}

/** Image of the line between two points of the world; null if it is before the near plane. */
export function seenLine(
  camera: Camera,
  box: ImageBox,
  from: Vec3,
  to: Vec3,
): readonly [Place, Place] | null {
  const [a, b] = [from, to].map((point) => transformedPoint(camera.viewMatrix, point));
  const [beyondA, beyondB] = [a, b].map(([, , z]) => -z - camera.near);
  if (Math.max(beyondA, beyondB) < 0) return null;
  const cut =
    beyondA < 0 === beyondB < 0 ? null : add(a, scale(subtract(b, a), beyondA / (beyondA - beyondB)));
  return [
    placeOf(camera, box, beyondA < 0 && cut ? cut : a),
    placeOf(camera, box, beyondB < 0 && cut ? cut : b),
  ];
}

/** Where a camera sees a point of the world; null if it is nearer than the near plane. */
export function seenPoint(camera: Camera, box: ImageBox, point: Vec3): Place | null {
  return seenLine(camera, box, point, point)?.[0] ?? null;
}

function placeOf({ projectionMatrix: p }: Camera, { width, height }: ImageBox, [x, y, z]: Vec3): Place {
  const w = p[11] * z + p[15];
  const right = (p[0] * x + p[8] * z + p[12]) / w;
  const up = (p[5] * y + p[9] * z + p[13]) / w;
  return [((1 + right) * width) / 2, ((1 - up) * height) / 2];
}

/** The twelve edges of a box, as pairs of corners. */
export function boxEdges({
  min,
  max,
}: {
  readonly min: Vec3;
  readonly max: Vec3;
}): (readonly [Vec3, Vec3])[] {
  const corner = (bits: number): Vec3 => [
    bits & 1 ? max[0] : min[0],
    bits & 2 ? max[1] : min[1],
    bits & 4 ? max[2] : min[2],
  ];
  return [1, 2, 4].flatMap((axis) =>
    [0, 1, 2, 3, 4, 5, 6, 7]
      .filter((bits) => (bits & axis) === 0)
      .map((bits) => [corner(bits), corner(bits | axis)] as const),
  );
}
