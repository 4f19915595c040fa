import { cameraAxes, type LookAt, lookAt, type OrbitPose } from '../state/orbit-pose.ts';
import { Y_UP } from '../state/up-axis.ts';
import { add, scale, type Vec3 } from '../state/vec3.ts';
import type { Sphere } from './scene-bounds.ts';

/** A little from the side and from above shows depth at once. */
const FIRST_AZIMUTH = 0.35;
const FIRST_POLAR = 1.25;
/**
 * How far a scene reaches beyond the ellipsoid within its box. Few fill the corners, and framed by
 * them they would be small.
 */
const ROUNDNESS = 1.2;
/** A camera that frames a scene stands outside of it: so many radii from its middle, at least. */
export const LEAST_DISTANCE_RADII = 1.5;
/** Nearest depth that is drawn, in radii of the scene; about that of most captures' training. */
const NEAR_RADII = 0.005;

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

/** `pose` moved, not turned, so that what `sphere` surrounds fills the narrower side of the image. */
export function framedPose(pose: OrbitPose, sphere: Sphere, fovYDegrees: number, aspect: number): OrbitPose {
  const { center, radius, halfSize } = sphere;
  let distance = fitDistance(radius, fovYDegrees, aspect);
  if (halfSize) {
    const sine = radius / distance;
    const cosine = Math.sqrt(1 - sine ** 2);
    const { right, above, back } = cameraAxes(pose);
    // In directions out of the image at its edges.
    const needed = [right, above].flatMap((axis) =>
      [cosine, -cosine].map((part) => reachOf(halfSize, add(scale(back, sine), scale(axis, part))) / sine),
    );
    distance = Math.min(distance, Math.max(...needed, LEAST_DISTANCE_RADII * radius));
  }
  return { ...pose, target: center, distance };
}

/** How far a scene in a box reaches in a direction from the middle of the box. */
function reachOf(halfSize: Vec3, direction: Vec3): number {
  const parts = halfSize.map((half, axis) => Math.abs(half * direction[axis]));
  return Math.min(parts[0] + parts[1] + parts[2], ROUNDNESS * Math.hypot(...parts));
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
