import { add, clamp, cross, dot, normalize, scale, subtract, type Vec3 } from './vec3.ts';

/** A camera that looks at `target` from `distance` away. */
export interface OrbitPose {
  readonly target: Vec3;
  /** World units from the camera to the target, above 0. */
  readonly distance: number;
  /** Radians around `up`; not wrapped, so that turning past a full circle keeps its direction. */
  readonly azimuth: number;
  /** Radians from `up`: near 0 the camera is above the target, near π below it. */
  readonly polar: number;
  /** Unit vector. */
  readonly up: Vec3;
}

export interface LookAt {
  readonly position: Vec3;
  readonly target: Vec3;
  readonly up: Vec3;
}

/** Distances that the camera may have from its target, in world units. */
export interface DistanceRange {
  readonly min: number;
  readonly max: number;
}

/** Radians that the camera keeps from the poles, where it would have no sideways direction. */
const POLAR_MARGIN = 0.01;

/** The three axes of an orbit around `up`: `up` itself and two directions across it. */
function orbitAxes(up: Vec3): { x: Vec3; z: Vec3 } {
  const across: Vec3 = Math.abs(up[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0];
  const x = normalize(cross(up, across));
  return { x, z: cross(x, up) };
}

/** Camera axes in world space: right, up and back (from the target to the camera). */
export function cameraAxes(pose: OrbitPose): { right: Vec3; above: Vec3; back: Vec3 } {
  const { x, z } = orbitAxes(pose.up);
  const sinPolar = Math.sin(pose.polar);
  const cosPolar = Math.cos(pose.polar);
  const outward = add(scale(x, Math.sin(pose.azimuth)), scale(z, Math.cos(pose.azimuth)));
  const back = add(scale(outward, sinPolar), scale(pose.up, cosPolar));
  const right = subtract(scale(x, Math.cos(pose.azimuth)), scale(z, Math.sin(pose.azimuth)));
  return { right, above: cross(back, right), back };
}

export function lookAt(pose: OrbitPose): LookAt {
  const { back } = cameraAxes(pose);
  return { position: add(pose.target, scale(back, pose.distance)), target: pose.target, up: pose.up };
}

/** The pose of a camera at `position` that looks at `target`. */
export function poseFromLookAt({ position, target, up }: LookAt): OrbitPose {
  const upUnit = normalize(up);
  const { x, z } = orbitAxes(upUnit);
  const offset = subtract(position, target);
  const distance = Math.hypot(...offset);
  if (!(distance > 0)) throw new RangeError('The camera and its target are the same point.');
  return {
    target,
    distance,
    azimuth: Math.atan2(dot(offset, x), dot(offset, z)),
    polar: clampPolar(Math.acos(clamp(dot(offset, upUnit) / distance, -1, 1))),
    up: upUnit,
  };
}

/** Turned around the target; the poles are not passed. */
export function orbited(pose: OrbitPose, azimuthBy: number, polarBy: number): OrbitPose {
  return { ...pose, azimuth: pose.azimuth + azimuthBy, polar: clampPolar(pose.polar + polarBy) };
}

/** Moved by `offset` along the camera's right, up and back axes, in world units. */
export function moved(pose: OrbitPose, offset: Vec3): OrbitPose {
  const { right, above, back } = cameraAxes(pose);
  const by = add(add(scale(right, offset[0]), scale(above, offset[1])), scale(back, offset[2]));
  return { ...pose, target: add(pose.target, by) };
}

/**
 * Moved so that things at the target's depth follow a pointer that went `dxPx`, `dyPx` (y down)
 * over an image of height `heightPx`.
 */
export function panned(
  pose: OrbitPose,
  dxPx: number,
  dyPx: number,
  heightPx: number,
  fovYDegrees: number,
): OrbitPose {
  const worldPerPx = (2 * pose.distance * Math.tan((fovYDegrees * Math.PI) / 360)) / heightPx;
  return moved(pose, [-dxPx * worldPerPx, dyPx * worldPerPx, 0]);
}

/** `factor` times as far from the target, within `range`. */
export function dollied(pose: OrbitPose, factor: number, range: DistanceRange): OrbitPose {
  return { ...pose, distance: clamp(pose.distance * factor, range.min, range.max) };
}

/** A place in the image: right and up of its middle, in halves of its height. */
export interface ImagePoint {
  readonly right: number;
  readonly up: number;
}

/**
 * Scales the camera's distance to the point under `at`, at the target's depth, by `factor`. The point
 * keeps its place in the image. The target's distance is clamped to `range`.
 */
export function dolliedAt(
  pose: OrbitPose,
  factor: number,
  range: DistanceRange,
  at: ImagePoint,
  fovYDegrees: number,
): OrbitPose {
  const { distance } = dollied(pose, factor, range);
  const halfHeight = pose.distance * Math.tan((fovYDegrees * Math.PI) / 360);
  const by = halfHeight * (1 - distance / pose.distance);
  return { ...moved(pose, [at.right * by, at.up * by, 0]), distance };
}

/**
 * Around `point`, which comes to the middle of the image at its depth: the camera moves sideways
 * without turning. A point nearer than `range` allows is looked at from there.
 */
export function focused(pose: OrbitPose, point: Vec3, range: DistanceRange): OrbitPose {
  const { back } = cameraAxes(pose);
  const depth = pose.distance - dot(subtract(point, pose.target), back);
  return { ...pose, target: point, distance: clamp(depth, range.min, range.max) };
}

/** Between two poses with the same `up`: linear in angles and target, geometric in distance. */
export function mixed(from: OrbitPose, to: OrbitPose, part: number): OrbitPose {
  return {
    target: add(scale(from.target, 1 - part), scale(to.target, part)),
    distance: from.distance ** (1 - part) * to.distance ** part,
    azimuth: from.azimuth + (to.azimuth - from.azimuth) * part,
    polar: from.polar + (to.polar - from.polar) * part,
    up: to.up,
  };
}

/** `pose` with its azimuth shifted by whole turns to be nearest to `azimuth`. */
export function unwound(pose: OrbitPose, azimuth: number): OrbitPose {
  const turns = Math.round((azimuth - pose.azimuth) / (2 * Math.PI));
  return { ...pose, azimuth: pose.azimuth + turns * 2 * Math.PI };
}

/** Near enough that the last step could not be seen: a hundredth of a pixel on a large screen. */
export function isClose(a: OrbitPose, b: OrbitPose): boolean {
  return (
    Math.abs(a.azimuth - b.azimuth) < 1e-5 &&
    Math.abs(a.polar - b.polar) < 1e-5 &&
    Math.abs(a.distance / b.distance - 1) < 1e-5 &&
    Math.hypot(...subtract(a.target, b.target)) < 1e-5 * b.distance
  );
}

function clampPolar(polar: number): number {
  return clamp(polar, POLAR_MARGIN, Math.PI - POLAR_MARGIN);
}
