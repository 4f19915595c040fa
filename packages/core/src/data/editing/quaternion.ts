import { wrongArgument } from '../given.ts';
import type { Vec3 } from '../math/mat4.ts';
import { checkNumbers } from './check-numbers.ts';

/** A rotation w, x, y, z. It may have any length above 0: so turns by right angles are exact. */
export type Quaternion = readonly [w: number, x: number, y: number, z: number];

export const IDENTITY: Quaternion = [1, 0, 0, 0];

/**
 * Rotations that turn an axis to +y, by the shortest way; −y by half a turn about x, which is how
 * captures are put upright.
 */
const UPRIGHT: Readonly<Record<string, Quaternion>> = {
  x: [1, 0, 0, 1],
  '-x': [1, 0, 0, -1],
  y: IDENTITY,
  '-y': [0, 1, 0, 0],
  z: [1, -1, 0, 0],
  '-z': [1, 1, 0, 0],
};

/** Names of axes, for `uprightRotation`. */
export const AXIS_NAMES: readonly string[] = Object.keys(UPRIGHT);

/**
 * The rotation that makes an axis point up, to +y.
 *
 * @param axis `x`, `-x`, `y`, `-y`, `z` or `-z`.
 * @throws InvalidArgumentError 'up' for anything else.
 * @example
 * // Most captures have y down.
 * const set = await readSplats('/garden.ply');
 * const upright = transformSplats(set, { rotation: uprightRotation('-y') });
 */
export function uprightRotation(axis: string): Quaternion {
  if (Object.hasOwn(UPRIGHT, axis)) return UPRIGHT[axis];
  throw wrongArgument('up', axis, `one of ${AXIS_NAMES.join(', ')}`);
}

/**
 * The rotation by angles in degrees about x, then y, then z, the axes of the scene.
 *
 * @throws InvalidArgumentError 'degrees' unless they are numbers.
 * @example
 * const set = await readSplats('/garden.ply');
 * const turned = transformSplats(set, { rotation: rotationByDegrees([0, 90, 0]) });
 */
export function rotationByDegrees(degrees: Vec3): Quaternion {
  checkNumbers('degrees', degrees, 3);
  const [x, y, z] = degrees.map(halfAngle);
  const aboutXY = multiplyQuaternions([y.cosine, 0, y.sine, 0], [x.cosine, x.sine, 0, 0]);
  return multiplyQuaternions([z.cosine, 0, 0, z.sine], aboutXY);
}

/**
 * The rotation by `b`, then by `a`.
 *
 * @example
 * // Upright, then a quarter turn about y.
 * const rotation = multiplyQuaternions(rotationByDegrees([0, 90, 0]), uprightRotation('-y'));
 * const turned = transformSplats(await readSplats('/garden.ply'), { rotation });
 */
export function multiplyQuaternions(a: Quaternion, b: Quaternion): Quaternion {
  return [
    a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
    a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
    a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
    a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
  ];
}

/**
 * The matrix of a rotation, 3×3, column-major.
 *
 * @example
 * const m = rotationMatrixOf(uprightRotation('-y'));
 * const modelMatrix = [m[0], m[1], m[2], 0, m[3], m[4], m[5], 0, m[6], m[7], m[8], 0, 0, 0, 0, 1];
 * view.render({ camera, clouds: [{ cloud, modelMatrix }], widthPx, heightPx });
 */
export function rotationMatrixOf([w, x, y, z]: Quaternion): Float64Array {
  const twice = 2 / (w * w + x * x + y * y + z * z);
  return Float64Array.of(
    ...[1 - twice * (y * y + z * z), twice * (x * y + w * z), twice * (x * z - w * y)],
    ...[twice * (x * y - w * z), 1 - twice * (x * x + z * z), twice * (y * z + w * x)],
    ...[twice * (x * z + w * y), twice * (y * z - w * x), 1 - twice * (x * x + y * y)],
  );
}

/** Cosine and sine of half an angle, or multiples of both: whole numbers for right angles. */
function halfAngle(degrees: number): { cosine: number; sine: number } {
  const rest = degrees % 360;
  switch (rest) {
    case 0:
      return { cosine: 1, sine: 0 };
    case 90:
    case -270:
      return { cosine: 1, sine: 1 };
    case 180:
    case -180:
      return { cosine: 0, sine: 1 };
    case 270:
    case -90:
      return { cosine: 1, sine: -1 };
  }
  const radians = (rest * Math.PI) / 360;
  return { cosine: Math.cos(radians), sine: Math.sin(radians) };
}
