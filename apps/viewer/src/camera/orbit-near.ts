import { type Camera, cameraPosition } from '@websplatter/core';
import { verticalFov } from '@websplatter/kit/vertical-fov';
import { FIRST_LOOK } from '../state/camera.ts';
import { type OrbitPose, poseFromLookAt } from '../state/orbit-pose.ts';
import type { Vec3 } from '../state/vec3.ts';
import { firstPose } from './framing.ts';
import type { Sphere } from './scene-bounds.ts';

/** A view of a scene from which orbiting can continue. */
export interface OrbitView {
  readonly pose: OrbitPose;
  /** Field of view over the image's shorter side, degrees. */
  readonly fovDegrees: number;
}

/**
 * The orbit that is closest to `camera`, so that the first movement jumps as little as possible.
 * Its target lies on the line of sight, as deep as the centre of `subject`.
 */
export function orbitNear(camera: Camera, subject: Sphere, aspect: number): OrbitView {
  const { viewMatrix: v, projectionMatrix: p } = camera;
  const position = cameraPosition(v);
  const [right, above, back]: Vec3[] = [0, 1, 2].map((row) => [v[row], v[4 + row], v[8 + row]]);
  const depth = subject.center.reduce((sum, value, axis) => sum - back[axis] * (value - position[axis]), 0);
  const along = (from: Vec3, by: number): Vec3 => [
    from[0] - by * back[0],
    from[1] - by * back[1],
    from[2] - by * back[2],
  ];
  // The world's up keeps horizons level. A camera that rolls or looks along it uses its own up.
  const isLevel = Math.abs(right[1]) < 1e-6 && above[1] > 0.05;
  const up: Vec3 = isLevel ? [0, 1, 0] : above;
  const target = along(position, depth);
  const isOrthographic = p[11] === 0;
  const fovYDegrees = isOrthographic
    ? verticalFov(FIRST_LOOK.fovDegrees, aspect)
    : (Math.atan(Math.abs(p[11] / p[5])) * 360) / Math.PI;
  const fovDegrees = shorterSideFov(fovYDegrees, aspect);
  // At the centre of the scene, perspective shows the same size as the parallel projection.
  const distance = isOrthographic ? Math.abs(p[15] / p[5]) / Math.tan((fovYDegrees * Math.PI) / 360) : depth;
  const eye = along(target, -distance);
  // Far from the world's origin, a short distance rounds to zero.
  const canOrbit = distance > 0 && eye.some((value, axis) => value !== target[axis]);
  const pose = canOrbit
    ? poseFromLookAt({ position: eye, target, up })
    : firstPose(subject, fovYDegrees, aspect);
  return { pose, fovDegrees };
}

/**
 * Field of view over the image's shorter side from the vertical one; the inverse of `verticalFov`.
 */
export function shorterSideFov(fovYDegrees: number, aspect: number): number {
  return (Math.atan(Math.tan((fovYDegrees * Math.PI) / 360) * Math.min(1, aspect)) * 360) / Math.PI;
}
