import { CHUNK_SPLATS, SHADER_CONSTANTS } from '../data/layout/constants.ts';
import { writeRotationMatrix } from '../data/math/rotation-matrix.ts';
import { logScalesOf } from '../data/packing/chunks.ts';
import { productOf } from '../data/packing/rotation.ts';
import { emptySplat, splatReader, type UnpackedSplat } from '../data/packing/unpack-geometry.ts';
import { clampElapsed, displacementAfter } from '../features/motion/splat-motion.data.ts';
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

const { LEAST_ROTATION, MOTION_WORDS } = SHADER_CONSTANTS;

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

/**
 * Returns a function that writes splat `index` of `piece` to `target`, from `at` on. It returns whether
 * the splat is visible.
 */
export function shapeReader(piece: GeometryPiece) {
  const { chunks, motion } = piece;
  const read = splatReader(piece, (index) => logScalesOf(chunks, Math.floor(index / CHUNK_SPLATS)));
  const splat = emptySplat();
  const { position, rotation, scale } = splat;
  const axes = new Float64Array(9);
  return (index: number, target: Float64Array, at: number): boolean => {
    read(index, splat);
    if (motion) move(splat, motion, index);
    const { opacity } = splat;
    if (!(opacity >= LEAST_OPACITY)) return false;
    writeRotationMatrix(rotation, axes);
    const [vx, vy, vz] = [scale[0] * scale[0], scale[1] * scale[1], scale[2] * scale[2]];
    const product = (row: number, column: number) =>
      vx * axes[row] * axes[column] +
      vy * axes[3 + row] * axes[3 + column] +
      vz * axes[6 + row] * axes[6 + column];
    const c = at + COVARIANCE;
    for (let axis = 0; axis < 3; axis++) {
      target[at + axis] = position[axis];
      target[c + axis] = product(axis, axis);
    }
    target[c + 3] = product(0, 1);
    target[c + 4] = product(0, 2);
    target[c + 5] = product(1, 2);
    target[at + OPACITY] = opacity;
    target[at + SIZE] = Math.max(scale[0], scale[1], scale[2]);
    target[at + WEIGHT] = opacity * areaOf(target, c);
    return true;
  };
}

/** Moves a splat to where it is at the time, as motion.wgsl does; pack-motion.ts has the layout. */
function move(
  splat: UnpackedSplat,
  { floats, time }: NonNullable<GeometryPiece['motion']>,
  index: number,
): void {
  const at = index * MOTION_WORDS;
  const away = time - floats[at + 3];
  const elapsed = clampElapsed(away);
  const { position, rotation } = splat;
  for (let from = at, axis = 0; axis < 3; axis++, from++)
    position[axis] += displacementAfter(elapsed, floats[from], floats[from + 4], floats[from + 8]);
  splat.opacity *= Math.exp(-((away * floats[at + 7]) ** 2));
  if (splat.opacity < LEAST_OPACITY) return;
  const turn = [0, 1, 2, 3].map((k) => (k === 0 ? 1 : 0) + elapsed * floats[at + 12 + k]);
  const turned = productOf(rotation, turn);
  const length = Math.hypot(...turned);
  if (length < LEAST_ROTATION) rotation.set([1, 0, 0, 0]);
  else for (let k = 0; k < 4; k++) rotation[k] = turned[k] / length;
}
