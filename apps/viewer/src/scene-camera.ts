import { lookAt, type OrbitPose, type Vec3 } from './orbit-controls.ts';

export interface Bounds {
  readonly min: Vec3;
  readonly max: Vec3;
}

export interface Sphere {
  readonly center: Vec3;
  readonly radius: number;
}

/**
 * Turns scenes whose y axis points down, as captures do that were solved with computer-vision conventions, the right
 * way up: half a turn around x, column-major.
 */
export const FLIP_MATRIX = Float64Array.of(1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1);

/** Field of view over the picture's shorter side. */
export const FIRST_FOV_DEGREES = 50;
/** A little from the side and from above shows depth at once. */
const FIRST_AZIMUTH = 0.35;
const FIRST_POLAR = 1.25;
/** Nearest depth that is drawn, as a part of the scene's radius; most captures were trained with about this. */
const NEAR_RADII = 0.005;

export function flippedPoint([x, y, z]: Vec3): Vec3 {
  return [x, -y, -z];
}

/** The pose from which a flipped scene shows the side that `pose` showed before, the other way up. */
export function flippedPose(pose: OrbitPose): OrbitPose {
  return { ...pose, target: flippedPoint(pose.target), azimuth: Math.PI - pose.azimuth };
}

export function boundingSphere({ min, max }: Bounds): Sphere {
  const center: Vec3 = [(min[0] + max[0]) / 2, (min[1] + max[1]) / 2, (min[2] + max[2]) / 2];
  const radius = Math.hypot(max[0] - min[0], max[1] - min[1], max[2] - min[2]) / 2;
  // A single splat, or all in one point, has no extent; it still needs a distance to be seen from.
  return { center, radius: radius > 0 && Number.isFinite(radius) ? radius : 1 };
}

/**
 * Vertical field of view, in degrees, of a picture that shows `fovDegrees` over its shorter side: what is seen in a
 * wide window is seen on an upright phone as well.
 */
export function verticalFov(fovDegrees: number, aspect: number): number {
  const halfTangent = Math.tan((fovDegrees * Math.PI) / 360) / Math.min(1, aspect);
  return (Math.atan(halfTangent) * 360) / Math.PI;
}

/** Distance from which a sphere fills the narrower side of the picture. */
export function fitDistance(radius: number, fovYDegrees: number, aspect: number): number {
  const halfY = (fovYDegrees * Math.PI) / 360;
  const half = Math.min(halfY, Math.atan(Math.tan(halfY) * aspect));
  return radius / Math.sin(half);
}

/** Where to look at a scene from first, with y up. */
export function firstPose(sphere: Sphere, fovYDegrees: number, aspect: number): OrbitPose {
  return framedPose(
    { target: sphere.center, distance: 1, azimuth: FIRST_AZIMUTH, polar: FIRST_POLAR, up: [0, 1, 0] },
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
 * Depths to draw, for a scene that lies within `extent` and is of the size of `subject` in the main.
 * The far end is a power of two times the near one: a camera that only turns keeps its projection.
 */
export function depthRange(pose: OrbitPose, subject: Sphere, extent: Sphere): { near: number; far: number } {
  const near = Math.min(subject.radius, pose.distance) * NEAR_RADII;
  const offset = lookAt(pose).position.map((value, axis) => value - extent.center[axis]);
  const farthest = Math.hypot(...offset) + extent.radius;
  return { near, far: near * 2 ** Math.ceil(Math.log2(Math.max(2, farthest / near))) };
}
