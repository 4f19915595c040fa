import { MOTION_SLOT, MOTION_VALUES } from '../../features/motion/splat-motion.data.ts';
import { InvalidArgumentError } from '../errors.ts';
import { given, wrongArgument } from '../given.ts';
import type { Vec3 } from '../math/mat4.ts';
import type { Harmonics } from '../packing/harmonics.ts';
import { givenSet } from '../splats/check-set.ts';
import { HarmonicsTurn } from '../splats/harmonics-turn.ts';
import { coefficientsPerSplat, type SplatSet } from '../splats/splat-set.ts';
import { checkNumbers } from './check-numbers.ts';
import { trainedCoefficients } from './limit-degree.ts';
import { placeSplats } from './place-splats.ts';
import { IDENTITY, multiplyQuaternions, type Quaternion, rotationMatrixOf } from './quaternion.ts';

/** How splats are moved: scaled about 0, then turned about 0, then shifted. */
export interface SplatTransform {
  /** Of any length above 0; default none. */
  readonly rotation?: Quaternion;
  /** The same along all axes, above 0; default 1. */
  readonly scale?: number;
  /** Default 0, 0, 0. */
  readonly translation?: Vec3;
}

/**
 * Moves splats with their harmonics, in float64; the origin is chosen anew. Unchanged values keep
 * their bits.
 *
 * @throws InvalidArgumentError 'rotation', 'scale' or 'translation' if it is none; 'set' if a splat
 *   would be too far away for float32.
 * @example
 * const set = await readSplats('/robot.ply', { shPrecision: 'f32' });
 * const placed = transformSplats(set, { scale: 0.5, translation: [2, 0, 0] });
 * const bytes = await writeSplats(placed, 'spz');
 */
export function transformSplats(set: SplatSet<Harmonics>, transform: SplatTransform): SplatSet<Harmonics> {
  const { rotation = IDENTITY, scale = 1, translation = [0, 0, 0] } = given(transform, {}, 'transform');
  givenSet(set);
  check(rotation, scale, translation);
  const isTurned = rotation.slice(1).some((value) => value !== 0);
  const isScaled = scale !== 1;
  const isMoved = isTurned || isScaled || translation.some((value) => value !== 0);
  if (!isMoved) return set;
  const matrix = rotationMatrixOf(rotation);
  return {
    ...set,
    ...placeSplats(movedPositions(set, matrix, scale, translation)),
    ...(set.motion &&
      (isTurned || isScaled) && { motion: placedMotion(set.motion, rotation, matrix, scale) }),
    ...(isScaled && { logScales: set.logScales.map((value) => value + Math.log(scale)) }),
    ...(isTurned && {
      rotations: turnedRotations(set, rotation),
      harmonics: { degree: set.harmonics.degree, coefficients: turnedCoefficients(set, matrix) },
    }),
  };
}

function check(rotation: Quaternion, scale: number, translation: Vec3): void {
  checkNumbers('rotation', rotation, 4);
  checkNumbers('translation', translation, 3);
  if (rotation.every((value) => value === 0))
    throw new InvalidArgumentError('rotation', 'rotation is 0, 0, 0, 0; a quaternion has a length above 0.');
  if (!(Number.isFinite(scale) && scale > 0)) throw wrongArgument('scale', scale, 'a number above 0');
}

function movedPositions(
  { count, positions, origin }: SplatSet<Harmonics>,
  m: Float64Array,
  scale: number,
  translation: Vec3,
): Float64Array {
  const moved = new Float64Array(3 * count);
  for (let i = 0; i < 3 * count; i += 3) {
    const x = scale * (positions[i] + origin[0]);
    const y = scale * (positions[i + 1] + origin[1]);
    const z = scale * (positions[i + 2] + origin[2]);
    for (let axis = 0; axis < 3; axis++)
      moved[i + axis] = m[axis] * x + m[3 + axis] * y + m[6 + axis] * z + translation[axis];
  }
  return moved;
}

function turnedRotations({ count, rotations }: SplatSet<Harmonics>, rotation: Quaternion): Float32Array {
  const unit = unitOf(rotation);
  const turned = new Float32Array(4 * count);
  for (let i = 0; i < 4 * count; i += 4) {
    const [w, x, y, z] = rotations.subarray(i, i + 4);
    // Zeros are the identity.
    const isZero = w === 0 && x === 0 && y === 0 && z === 0;
    turned.set(multiplyQuaternions(unit, [isZero ? 1 : w, x, y, z]), i);
  }
  return turned;
}

/** Scales and turns how splats move, and turns their turns as their rotations. */
function placedMotion(
  motion: Float32Array,
  rotation: Quaternion,
  m: Float64Array,
  scale: number,
): Float32Array {
  const unit = unitOf(rotation);
  const placed = motion.slice();
  for (let at = 0; at < motion.length; at += MOTION_VALUES) {
    for (const slot of [MOTION_SLOT.velocity, MOTION_SLOT.acceleration, MOTION_SLOT.jerk]) {
      const [x, y, z] = motion.subarray(at + slot, at + slot + 3);
      for (let axis = 0; axis < 3; axis++)
        placed[at + slot + axis] = scale * (m[axis] * x + m[3 + axis] * y + m[6 + axis] * z);
    }
    const [w, x, y, z] = motion.subarray(at + MOTION_SLOT.turn, at + MOTION_VALUES);
    placed.set(multiplyQuaternions(unit, [w, x, y, z]), at + MOTION_SLOT.turn);
  }
  return placed;
}

function unitOf(rotation: Quaternion): Quaternion {
  const length = Math.hypot(...rotation);
  return rotation.map((value) => value / length) as unknown as Quaternion;
}

function turnedCoefficients(set: SplatSet<Harmonics>, matrix: Float64Array): Float32Array {
  const { degree } = set.harmonics;
  const coefficients = trainedCoefficients(set);
  if (degree === 0) return coefficients;
  const turn = new HarmonicsTurn(degree, matrix);
  const width = coefficientsPerSplat(degree);
  for (let at = 0; at < coefficients.length; at += width) turn.apply(coefficients, at);
  return coefficients;
}
