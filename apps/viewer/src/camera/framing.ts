import { cameraAxes, type LookAt, lookAt, type OrbitPose } from '../state/orbit-pose.ts';
import { Y_UP } from '../state/up-axis.ts';
import { add, scale, type Vec3 } from '../state/vec3.ts';
import type { Sphere } from './scene-bounds.ts';

/** The first view is slightly from the side and from above, which shows depth. */
const FIRST_AZIMUTH = 0.35;
const FIRST_POLAR = 1.25;
/**
 * Extent of a scene relative to the ellipsoid in its bounding box. Few scenes fill the corners;
 * framing the corners would make the others small.
 */
const ROUNDNESS = 1.2;
/** Least distance of a camera that frames a scene from its centre, in radii of the scene. */
export const LEAST_DISTANCE_RADII = 1.5;
/** Near plane, in radii of the scene; about the near plane with which most captures are trained. */
const NEAR_RADII = 0.005;

/** Distance from which a sphere fills the shorter side of the image. */
export function fitDistance(radius: number, fovYDegrees: number, aspect: number): number {
  const halfY = (fovYDegrees * Math.PI) / 360;
  const half = Math.min(halfY, Math.atan(Math.tan(halfY) * aspect));
  return radius / Math.sin(half);
}

/** The first pose for a scene without one of its own. */
export function firstPose(sphere: Sphere, fovYDegrees: number, aspect: number, up: Vec3 = Y_UP): OrbitPose {
  return framedPose(
    { target: sphere.center, distance: 1, azimuth: FIRST_AZIMUTH, polar: FIRST_POLAR, up },
    sphere,
    fovYDegrees,
    aspect,
  );
}

/**
 * Moves `pose` without turning it, so that `sphere` or its box fills the shorter side of the image.
 */
export function framedPose(pose: OrbitPose, sphere: Sphere, fovYDegrees: number, aspect: number): OrbitPose {
  const { center, radius, halfSize } = sphere;
  let distance = fitDistance(radius, fovYDegrees, aspect);
  if (halfSize) {
    const sine = radius / distance;
    const cosine = Math.sqrt(1 - sine ** 2);
    const { right, above, back } = cameraAxes(pose);
    // Along directions from the box to the edges of the image.
    const needed = [right, above].flatMap((axis) =>
      [cosine, -cosine].map((part) => reachOf(halfSize, add(scale(back, sine), scale(axis, part))) / sine),
    );
    distance = Math.min(distance, Math.max(...needed, LEAST_DISTANCE_RADII * radius));
  }
  return { ...pose, target: center, distance };
}

/** Extent of a box-shaped scene in a direction, from the centre of the box. */
function reachOf(halfSize: Vec3, direction: Vec3): number {
  const parts = halfSize.map((half, axis) => Math.abs(half * direction[axis]));
  return Math.min(parts[0] + parts[1] + parts[2], ROUNDNESS * Math.hypot(...parts));
}

/**
 * Near and far plane for a scene that lies within `extent` and mostly within `subject`. The far
 * plane is a power of two times the near one, so that turning the camera keeps its projection.
 */
export function depthRange(pose: OrbitPose, subject: Sphere, extent: Sphere): { near: number; far: number } {
  const near = Math.min(subject.radius, pose.distance) * NEAR_RADII;
  const offset = lookAt(pose).position.map((value, axis) => value - extent.center[axis]);
  const farthest = Math.hypot(...offset) + extent.radius;
  return { near, far: near * 2 ** Math.ceil(Math.log2(Math.max(2, farthest / near))) };
}

/** A parallel projection: the camera's position, and its near and far plane. */
export interface ParallelView extends LookAt {
  /** Height of the image in world units. */
  readonly height: number;
  readonly near: number;
  readonly far: number;
}

/**
 * Shows the target of `pose` at the same size as in perspective. The camera stands outside of
 * `extent`, so that the whole scene is visible, however near the pose is.
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
