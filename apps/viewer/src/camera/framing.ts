import { type LookAt, lookAt, type OrbitPose } from './orbit-pose.ts';
import type { Sphere } from './scene-bounds.ts';
import { Y_UP } from './up-axis.ts';
import type { Vec3 } from './vec3.ts';

/** A little from the side and from above shows depth at once. */
const FIRST_AZIMUTH = 0.35;
const FIRST_POLAR = 1.25;
/** Nearest depth that is drawn, in radii of the scene; about that of most captures' training. */
const NEAR_RADII = 0.005;

/**
 * Vertical field of view, in degrees, of an image that shows `fovDegrees` over its shorter side. An
 * upright phone then shows as much as a wide window.
 */
export function verticalFov(fovDegrees: number, aspect: number): number {
  const halfTangent = Math.tan((fovDegrees * Math.PI) / 360) / Math.min(1, aspect);
  return (Math.atan(halfTangent) * 360) / Math.PI;
}

/** The field of view over an image's shorter side for the vertical one: undoes `verticalFov`. */
export function shorterSideFov(fovYDegrees: number, aspect: number): number {
  return (Math.atan(Math.tan((fovYDegrees * Math.PI) / 360) * Math.min(1, aspect)) * 360) / Math.PI;
}

/** Distance from which a sphere fills the narrower side of the image. */
export function fitDistance(radius: number, fovYDegrees: number, aspect: number): number {
  const halfY = (fovYDegrees * Math.PI) / 360;
  const half = Math.min(halfY, Math.atan(Math.tan(halfY) * aspect));
  return radius / Math.sin(half);
}

/** The first pose for a scene. */
export function firstPose(sphere: Sphere, fovYDegrees: number, aspect: number, up: Vec3 = Y_UP): OrbitPose {
  return framedPose(
    { target: sphere.center, distance: 1, azimuth: FIRST_AZIMUTH, polar: FIRST_POLAR, up },
    sphere,
    fovYDegrees,
    aspect,
  );
}

/** `pose` moved, not turned, so that it shows all of `sphere`. */
export function framedPose(pose: OrbitPose, sphere: Sphere, fovYDegrees: number, aspect: number): OrbitPose {
  return { ...pose, target: sphere.center, distance: fitDistance(sphere.radius, fovYDegrees, aspect) };
}

/**
 * Depths to draw of a scene that lies within `extent` and mostly within `subject`. The far end is a
 * power of two times the near one: a camera that only turns keeps its projection.
 */
export function depthRange(pose: OrbitPose, subject: Sphere, extent: Sphere): { near: number; far: number } {
  const near = Math.min(subject.radius, pose.distance) * NEAR_RADII;
  const offset = lookAt(pose).position.map((value, axis) => value - extent.center[axis]);
  const farthest = Math.hypot(...offset) + extent.radius;
  return { near, far: near * 2 ** Math.ceil(Math.log2(Math.max(2, farthest / near))) };
}

/** A parallel projection: the camera's place, and the depths that it sees. */
export interface ParallelView extends LookAt {
  /** World units that the image is high. */
  readonly height: number;
  readonly near: number;
  readonly far: number;
}

/**
 * Shows the target of `pose` as large as perspective does there. The camera stands outside of
 * `extent`, so that it sees all of it, however near the pose is.
 */
export function parallelView(pose: OrbitPose, extent: Sphere, fovYDegrees: number): ParallelView {
  const offset = Math.hypot(...pose.target.map((value, axis) => value - extent.center[axis]));
  const outside = (offset + extent.radius) * (1 + 2 * NEAR_RADII);
  return {
    ...lookAt({ ...pose, distance: outside }),
    height: 2 * pose.distance * Math.tan((fovYDegrees * Math.PI) / 360),
    near: outside * NEAR_RADII,
    far: 2 * outside,
  };
}
