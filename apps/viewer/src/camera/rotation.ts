import { type OrbitPose, poseFromLookAt } from '../state/orbit-pose.ts';
import { add, dot, normalize, scale, type Vec3 } from '../state/vec3.ts';

/** A unit quaternion that turns a camera that looks along −z with y up. */
export type Quaternion = readonly [x: number, y: number, z: number, w: number];

/** A camera's right, up and back as unit vectors at right angles. */
export interface CameraAxes {
  readonly right: Vec3;
  readonly above: Vec3;
  readonly back: Vec3;
}

/** The quaternion of a camera, by Shepperd's method: the largest component first. */
export function quaternionOf({ right, above, back }: CameraAxes): Quaternion {
  const trace = right[0] + above[1] + back[2];
  const squares = [right[0], above[1], back[2], trace].map(
    (value, i) => 1 + (i === 3 ? trace : 2 * value - trace),
  );
  const largest = squares.indexOf(Math.max(...squares));
  const twice = 2 * Math.sqrt(squares[largest]);
  const [yz, zx, xy] = [above[2] + back[1], back[0] + right[2], right[1] + above[0]];
  const [x, y, z] = [above[2] - back[1], back[0] - right[2], right[1] - above[0]];
  const whole = squares[largest];
  const values = [
    [whole, xy, zx, x],
    [xy, whole, yz, y],
    [zx, yz, whole, z],
    [x, y, z, whole],
  ][largest].map((value, i) => (i === largest ? twice / 4 : value / twice));
  return [values[0], values[1], values[2], values[3]];
}

/** The axes of a camera turned by a quaternion of any length above 0. */
export function axesOf(turn: Quaternion): CameraAxes {
  const length = Math.hypot(...turn);
  const [x, y, z, w] = turn.map((value) => value / length);
  return {
    right: [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)],
    above: [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)],
    back: [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)],
  };
}

/** Cosine between a level camera's right and up, up to rounding in single precision. */
const LEVEL_COSINE = 1e-6;
/** Steeper cameras keep their own up: around `up` they would have no direction sideways. */
const LEAST_SINE = 0.05;

/**
 * The orbit of a camera at `position`, around the point `distance` in front of it.
 *
 * @param up the direction that level cameras keep upright; cameras that roll have their own up.
 */
export function poseOfAxes(
  position: Vec3,
  { right, above, back }: CameraAxes,
  distance: number,
  up: Vec3,
): OrbitPose {
  const isLevel = Math.abs(dot(right, up)) < LEVEL_COSINE && dot(above, up) > LEAST_SINE;
  const target = add(position, scale(back, -distance));
  return poseFromLookAt({ position, target, up: isLevel ? up : normalize(above) });
}
