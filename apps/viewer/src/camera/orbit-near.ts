import { type Camera, cameraPosition } from '@websplatter/core';
import { verticalFov } from '@websplatter/kit/vertical-fov';
import { FIRST_LOOK } from '../state/camera.ts';
import { type OrbitPose, poseFromLookAt } from '../state/orbit-pose.ts';
import type { Vec3 } from '../state/vec3.ts';
import { firstPose } from './framing.ts';
import type { Sphere } from './scene-bounds.ts';

/** A view of a scene from which orbiting goes on. */
export interface OrbitView {
  readonly pose: OrbitPose;
  /** Field of view over the image's shorter side. */
  readonly fovDegrees: number;
}

/**
 * The orbit that comes closest to `camera`, so that the first movement jumps as little as possible:
 * around the point of its line of sight that is as deep as the middle of `subject`.
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
  // The world's up keeps horizons level; a camera that rolls, or looks along it, has only its own.
  const isLevel = Math.abs(right[1]) < 1e-6 && above[1] > 0.05;
  const up: Vec3 = isLevel ? [0, 1, 0] : above;
  const target = along(position, depth);
  const isOrthographic = p[11] === 0;
  const fovYDegrees = isOrthographic
    ? verticalFov(FIRST_LOOK.fovDegrees, aspect)
    : (Math.atan(Math.abs(p[11] / p[5])) * 360) / Math.PI;
  const fovDegrees = shorterSideFov(fovYDegrees, aspect);
  // At the middle of the scene, perspective shows things as large as the parallel projection does.
  const distance = isOrthographic ? Math.abs(p[15] / p[5]) / Math.tan((fovYDegrees * Math.PI) / 360) : depth;
  const eye = along(target, -distance);
  // Far from the world's origin a short distance rounds to none.
  const canOrbit = distance > 0 && eye.some((value, axis) => value !== target[axis]);
  const pose = canOrbit
    ? poseFromLookAt({ position: eye, target, up })
    : firstPose(subject, fovYDegrees, aspect);
  return { pose, fovDegrees };
}

/** The field of view over an image's shorter side for the vertical one: undoes `verticalFov`. */
function shorterSideFov(fovYDegrees: number, aspect: number): number {
  return (Math.atan(Math.tan((fovYDegrees * Math.PI) / 360) * Math.min(1, aspect)) * 360) / Math.PI;
}
