import { cameraAxes, type OrbitPose, poseFromLookAt } from '../state/orbit-pose.ts';
import { type UpAxis, uprightnessOf, upVector } from '../state/up-axis.ts';
import type { Vec3 } from '../state/vec3.ts';

/**
 * A half turn around x, column-major. It turns scenes upright whose y axis points down, as in
 * captures with computer-vision conventions.
 */
const FLIP_MATRIX = Float64Array.of(1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1);

/**
 * The model matrix of a cloud in a flipped scene.
 *
 * @param modelMatrix the matrix in the unflipped scene.
 */
export function flippedMatrix(modelMatrix: ArrayLike<number> | undefined): ArrayLike<number> {
  if (!modelMatrix) return FLIP_MATRIX;
  // The flip from the left negates the rows of y and z.
  return Float64Array.from(modelMatrix, (value, i) => (i % 4 === 1 || i % 4 === 2 ? -value : value));
}

export function flippedPoint([x, y, z]: Vec3): Vec3 {
  // Subtracts from 0 so that 0 does not become −0.
  return [x, 0 - y, 0 - z];
}

/**
 * The pose from which a flipped scene shows the same side as `pose` does unflipped, upside down.
 */
export function flippedPose(pose: OrbitPose): OrbitPose {
  const { up } = pose;
  const flippedUp: Vec3 = [0 - up[0], up[1], up[2]];
  // Level directions stay level but are seen from the other side, so the azimuth changes its sign.
  const { back } = cameraAxes({ ...pose, azimuth: 0, polar: Math.PI / 2 });
  const first = poseFromLookAt({ position: flippedPoint(back), target: [0, 0, 0], up: flippedUp });
  return { ...pose, target: flippedPoint(pose.target), azimuth: first.azimuth - pose.azimuth, up: flippedUp };
}

/**
 * The pose for another axis up. Between opposite axes, it faces the same side; between y and z, x stays where
 * it points. So each order of turns that ends with the same axis ends with the same pose.
 */
export function turnedPose(pose: OrbitPose, from: UpAxis, to: UpAxis): OrbitPose {
  const [before, after] = [uprightnessOf(from), uprightnessOf(to)];
  // Turns between y and z commute with turns upside down.
  const flipped = before.isFlipped === after.isFlipped ? pose : flippedPose(pose);
  if (before.isZUp === after.isZUp) return flipped;
  const azimuth = flipped.azimuth + (after.isZUp ? -Math.PI / 2 : Math.PI / 2);
  return { ...flipped, azimuth, up: upVector(after) };
}
