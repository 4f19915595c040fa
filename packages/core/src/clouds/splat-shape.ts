import { CHUNK_SPLATS, SHADER_CONSTANTS } from '../data/layout/constants.ts';
import { logScalesOf } from '../data/packing/chunks.ts';
import { GEOMETRY_WORDS, unpackRotation } from '../data/packing/geometry.ts';
import { productOf } from '../data/packing/rotation.ts';
import type { GeometryPiece } from './geometry-pieces.ts';

/** Opacity below which splats are left out. */
export const LEAST_OPACITY = 1 / 255;

// A shape is a splat without its colour, SHAPE_VALUES numbers that begin with its centre.
/** Covariance: xx, yy, zz, xy, xz, yz. */
export const COVARIANCE = 3;
export const OPACITY = 9;
/** Largest standard deviation. */
export const SIZE = 10;
/** The splat's share of an image: its opacity times its area. */
export const WEIGHT = 11;
export const SHAPE_VALUES = 12;

const { LEAST_ROTATION, MOST_ELAPSED, MOTION_WORDS } = SHADER_CONSTANTS;

/** Mean projected area of an ellipsoid over all directions, up to a constant factor. */
export function areaOf(values: Float64Array, covariance: number): number {
  const xx = values[covariance];
  const yy = values[covariance + 1];
  const zz = values[covariance + 2];
  const xy = values[covariance + 3];
  const xz = values[covariance + 4];
  const yz = values[covariance + 5];
  // The sum of squared areas between pairs of axes, which is invariant under rotation.
  const squares = xx * yy - xy * xy + xx * zz - xz * xz + yy * zz - yz * yz;
  return Math.sqrt(Math.max(1e-80, squares));
}

/** Writes splat `index` of `geometry` to `target`; returns whether it is visible. */
export function unpackShape(
  { precision, words, chunks, motion }: GeometryPiece,
  floats: Float32Array,
  index: number,
  target: Float64Array,
  at: number,
): boolean {
  const from = index * GEOMETRY_WORDS[precision];
  const isF32 = precision === 'f32';
  let opacity = isF32 ? floats[from + 3] : (words[from + 4] >>> 16) / 65535;
  if (motion) {
    move(motion, index);
    opacity *= MOVEMENT[SHARE];
  }
  if (!(opacity >= LEAST_OPACITY)) return false;
  let sx: number;
  let sy: number;
  let sz: number;
  const q = QUATERNION;
  if (isF32) {
    for (let k = 0; k < 4; k++) q[k] = floats[from + 4 + k];
    sx = floats[from + 8];
    sy = floats[from + 9];
    sz = floats[from + 10];
  } else {
    const { min, step } = logScalesOf(chunks, Math.floor(index / CHUNK_SPLATS));
    sx = Math.exp(min + step * (words[from + 5] & 0xffff));
    sy = Math.exp(min + step * (words[from + 5] >>> 16));
    sz = Math.exp(min + step * (words[from + 6] & 0xffff));
    unpackRotation(words[from + 6] >>> 16, words[from + 7], q);
  }
  if (motion) turn(q);
  const [w, x, y, z] = q;
  const xxs = 1 - 2 * (y * y + z * z);
  const xys = 2 * (x * y - w * z);
  const xzs = 2 * (x * z + w * y);
  const yxs = 2 * (x * y + w * z);
  const yys = 1 - 2 * (x * x + z * z);
  const yzs = 2 * (y * z - w * x);
  const zxs = 2 * (x * z - w * y);
  const zys = 2 * (y * z + w * x);
  const zzs = 1 - 2 * (x * x + y * y);
  const vx = sx * sx;
  const vy = sy * sy;
  const vz = sz * sz;
  const c = at + COVARIANCE;
  for (let axis = 0; axis < 3; axis++)
    target[at + axis] = floats[from + axis] + (motion ? MOVEMENT[axis] : 0);
  target[c] = vx * xxs * xxs + vy * xys * xys + vz * xzs * xzs;
  target[c + 1] = vx * yxs * yxs + vy * yys * yys + vz * yzs * yzs;
  target[c + 2] = vx * zxs * zxs + vy * zys * zys + vz * zzs * zzs;
  target[c + 3] = vx * xxs * yxs + vy * xys * yys + vz * xzs * yzs;
  target[c + 4] = vx * xxs * zxs + vy * xys * zys + vz * xzs * zzs;
  target[c + 5] = vx * yxs * zxs + vy * yys * zys + vz * yzs * zzs;
  target[at + OPACITY] = opacity;
  target[at + SIZE] = Math.max(sx, sy, sz);
  target[at + WEIGHT] = opacity * areaOf(target, c);
  return true;
}

/**
 * Writes to MOVEMENT where the motion of a splat has taken it: its displacement, the factor of its
 * opacity, and the turn in its own frame. motion.wgsl does the same; pack-motion.ts has the layout.
 */
function move({ floats, time }: NonNullable<GeometryPiece['motion']>, index: number): void {
  const at = index * MOTION_WORDS;
  const away = time - floats[at + 3];
  const elapsed = Math.max(-MOST_ELAPSED, Math.min(MOST_ELAPSED, away));
  for (let axis = 0; axis < 3; axis++) {
    const from = at + axis;
    MOVEMENT[axis] = elapsed * (floats[from] + elapsed * (floats[from + 4] + elapsed * floats[from + 8]));
  }
  MOVEMENT[SHARE] = Math.exp(-((away * floats[at + 7]) ** 2));
  for (let k = 0; k < 4; k++) MOVEMENT[TURN + k] = (k === 0 ? 1 : 0) + elapsed * floats[at + 12 + k];
}

/** Multiplies a unit quaternion by the turn of MOVEMENT, as a unit; the identity if that cancels it. */
function turn(q: Float64Array): void {
  const product = productOf(q, TURNED);
  const length = Math.hypot(...product);
  if (length < LEAST_ROTATION) q.set([1, 0, 0, 0]);
  else for (let k = 0; k < 4; k++) q[k] = product[k] / length;
}

const QUATERNION = new Float64Array(4);
/** Displacement, share of the opacity, turn w, x, y, z. */
const MOVEMENT = new Float64Array(8);
const [SHARE, TURN] = [3, 4];
const TURNED = MOVEMENT.subarray(TURN);
