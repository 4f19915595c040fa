import { type Bounds, type Camera, type CloudInstance, cameraPosition } from '@websplatter/core';
import { lookAt, type OrbitPose, poseFromLookAt, type Vec3 } from './orbit-controls.ts';

export interface Sphere {
  readonly center: Vec3;
  readonly radius: number;
}

/**
 * Turns scenes whose y axis points down, as captures do that were solved with computer-vision conventions, the right
 * way up: half a turn around x, column-major.
 */
const FLIP_MATRIX = Float64Array.of(1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1);

/** Where a cloud stands, after `modelMatrix`, in a scene that is turned. */
export function flippedMatrix(modelMatrix: ArrayLike<number> | undefined): ArrayLike<number> {
  if (!modelMatrix) return FLIP_MATRIX;
  // The flip from the left negates the rows of y and z.
  return Float64Array.from(modelMatrix, (value, i) => (i % 4 === 1 || i % 4 === 2 ? -value : value));
}

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

/** A box around all clouds where they stand; `part` says which of a cloud's own boxes counts. */
export function boundsOf(clouds: readonly CloudInstance[], part: 'bounds' | 'robustBounds'): Bounds {
  const min: [number, number, number] = [Infinity, Infinity, Infinity];
  const max: [number, number, number] = [-Infinity, -Infinity, -Infinity];
  for (const { cloud, modelMatrix } of clouds) {
    // A cloud without splats is nowhere.
    if (cloud.count === 0) continue;
    for (const corner of cornersOf(cloud[part])) {
      const point = modelMatrix ? transformedPoint(modelMatrix, corner) : corner;
      for (const axis of [0, 1, 2]) {
        min[axis] = Math.min(min[axis], point[axis]);
        max[axis] = Math.max(max[axis], point[axis]);
      }
    }
  }
  return min.every(Number.isFinite) && max.every(Number.isFinite)
    ? { min, max }
    : { min: [0, 0, 0], max: [0, 0, 0] };
}

function cornersOf({ min, max }: Bounds): Vec3[] {
  return Array.from({ length: 8 }, (_, i) => [
    i & 1 ? max[0] : min[0],
    i & 2 ? max[1] : min[1],
    i & 4 ? max[2] : min[2],
  ]);
}

function transformedPoint(m: ArrayLike<number>, [x, y, z]: Vec3): Vec3 {
  const row = (i: number) => m[i] * x + m[4 + i] * y + m[8 + i] * z + m[12 + i];
  return [row(0), row(1), row(2)];
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

/** The field of view over the shorter side of a picture whose vertical one is `fovYDegrees`: undoes `verticalFov`. */
function shorterSideFov(fovYDegrees: number, aspect: number): number {
  return (Math.atan(Math.tan((fovYDegrees * Math.PI) / 360) * Math.min(1, aspect)) * 360) / Math.PI;
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

/** A way to look at a scene from which orbiting goes on. */
export interface OrbitView {
  readonly pose: OrbitPose;
  /** Field of view over the picture's shorter side. */
  readonly fovDegrees: number;
}

/**
 * The orbit that comes closest to `camera`, so that the first movement does not jump where that can be helped: around
 * the point of its line of sight that is as deep as the middle of `subject`.
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
    ? verticalFov(FIRST_FOV_DEGREES, aspect)
    : (Math.atan(Math.abs(p[11] / p[5])) * 360) / Math.PI;
  const fovDegrees = shorterSideFov(fovYDegrees, aspect);
  // What is as large in the parallel picture is as large in perspective, in the middle of the scene.
  const distance = isOrthographic ? Math.abs(p[15] / p[5]) / Math.tan((fovYDegrees * Math.PI) / 360) : depth;
  const eye = along(target, -distance);
  // Far from the world's origin a short distance rounds to none.
  const canOrbit = distance > 0 && eye.some((value, axis) => value !== target[axis]);
  const pose = canOrbit
    ? poseFromLookAt({ position: eye, target, up })
    : firstPose(subject, fovYDegrees, aspect);
  return { pose, fovDegrees };
}
