import type { Turns } from '../../data/turns.ts';
import { COVARIANCE, LEAST_OPACITY, OPACITY } from '../splat-shape.ts';
import { LOOSE_VALUES, MOST_OPACITY } from './ray-blobs.ts';

/** Blobs per node of the lowest level, and children per node of the other levels. */
export const ARITY = 8;
/**
 * Unsigned 16-bit values per blob: mean 3, standard deviation 3, angle 3, opacity 1. Deviations and
 * angles encode the lower triangle L of the covariance L·Lᵀ. The length of a row is the deviation
 * along its axis; the angles give its direction. Rounded correlations would instead thicken thin
 * splats, by the square root of their rounding.
 */
export const BLOB_VALUES = 10;
/** Means are steps between the faces of their node's box. */
export const MEAN_STEPS = 65535;
/** Standard deviations are powers of two, in steps of 1/1024 about 1. */
export const DEVIATION_STEPS = 1024;
export const DEVIATION_ZERO = 32768;
/** Steps of half a turn. Even, so that the right angle is exact. */
export const ANGLE_STEPS = 65534;

/** Blobs in an order that keeps neighbours together, and a bounding box per run of ARITY blobs. */
export interface RayBlobs {
  readonly count: number;
  /** BLOB_VALUES per blob. */
  readonly values: Uint16Array;
  /** Min x, y, z and max x, y, z per run: the box around the extents of its blobs. */
  readonly boxes: Float32Array;
}

/**
 * Sorts blobs, LOOSE_VALUES each, so that each run of ARITY is compact, each run of ARITY² too, and
 * so on; then rounds their values.
 */
export async function arrangeBlobs(blobs: Float32Array, turns: Turns): Promise<RayBlobs> {
  const count = blobs.length / LOOSE_VALUES;
  const keys = keysOf(blobs);
  const order = new Uint32Array(count);
  for (let i = 0; i < count; i++) order[i] = i;
  const ranges: [start: number, end: number][] = [[0, count]];
  for (let range = ranges.pop(); range; range = ranges.pop()) {
    const [start, end] = range;
    if (end - start <= ARITY) continue;
    await turns.give();
    // The border between two runs that is nearest to the middle.
    const run = ARITY ** Math.ceil(Math.log(end - start) / Math.log(ARITY) - 1 - 1e-9);
    const middle = start + run * Math.max(1, Math.round((end - start) / run / 2));
    split(keys[widestAxis(keys, order, start, end)], order, start, middle, end);
    ranges.push([start, middle], [middle, end]);
  }
  const values = new Uint16Array(BLOB_VALUES * count);
  const boxes = new Float32Array(6 * Math.ceil(count / ARITY));
  for (let node = 0; 6 * node < boxes.length; node++) {
    await turns.give();
    const members = order.subarray(ARITY * node, ARITY * (node + 1));
    const box = boxes.subarray(6 * node, 6 * (node + 1));
    bound(blobs, members, box);
    for (const [i, blob] of members.entries())
      round(blobs.subarray(LOOSE_VALUES * blob), box, values.subarray(BLOB_VALUES * (ARITY * node + i)));
  }
  return { count, values, boxes };
}

/**
 * x, y, z and size per blob. Sorting by size keeps large and small blobs apart, so few boxes are
 * wide.
 */
function keysOf(blobs: Float32Array): Float32Array[] {
  const count = blobs.length / LOOSE_VALUES;
  const keys = [0, 1, 2, 3].map(() => new Float32Array(count));
  for (let i = 0, at = 0; i < count; i++, at += LOOSE_VALUES) {
    for (let axis = 0; axis < 3; axis++) keys[axis][i] = blobs[at + axis];
    const variances = blobs[at + COVARIANCE] + blobs[at + COVARIANCE + 1] + blobs[at + COVARIANCE + 2];
    keys[3][i] = 2 * Math.sqrt(variances);
  }
  return keys;
}

function widestAxis(keys: readonly Float32Array[], order: Uint32Array, start: number, end: number): number {
  let widest = 0;
  let most = -1;
  for (const [axis, key] of keys.entries()) {
    let min = Number.POSITIVE_INFINITY;
    let max = Number.NEGATIVE_INFINITY;
    for (let i = start; i < end; i++) {
      const value = key[order[i]];
      if (value < min) min = value;
      if (value > max) max = value;
    }
    if (max - min > most) {
      most = max - min;
      widest = axis;
    }
  }
  return widest;
}

/** Brings the smallest keys of a range before `middle`: Hoare's selection. */
function split(key: Float32Array, order: Uint32Array, start: number, middle: number, end: number): void {
  let low = start;
  let high = end - 1;
  while (low < high) {
    const pivot = key[order[(low + high) >> 1]];
    let i = low;
    let j = high;
    while (i <= j) {
      while (key[order[i]] < pivot) i++;
      while (key[order[j]] > pivot) j--;
      if (i > j) break;
      const swapped = order[i];
      order[i++] = order[j];
      order[j--] = swapped;
    }
    if (middle <= j) high = j;
    else if (middle >= i) low = i;
    else return;
  }
}

/** Writes the box around the extents of `members`. */
function bound(blobs: Float32Array, members: Uint32Array, box: Float32Array): void {
  for (let axis = 0; axis < 3; axis++) {
    let min = Number.POSITIVE_INFINITY;
    let max = Number.NEGATIVE_INFINITY;
    for (const blob of members) {
      const at = LOOSE_VALUES * blob;
      const deviations = Math.sqrt(2 * Math.log(blobs[at + OPACITY] / LEAST_OPACITY));
      const reach = deviations * Math.sqrt(blobs[at + COVARIANCE + axis]);
      min = Math.min(min, blobs[at + axis] - reach);
      max = Math.max(max, blobs[at + axis] + reach);
    }
    box[axis] = min;
    box[3 + axis] = max;
  }
}

function round(blob: Float32Array, box: Float32Array, values: Uint16Array): void {
  for (let axis = 0; axis < 3; axis++) {
    const side = box[3 + axis] - box[axis];
    values[axis] = side > 0 ? Math.round(((blob[axis] - box[axis]) / side) * MEAN_STEPS) : 0;
    const steps = 0.5 * Math.log2(Math.max(1e-38, blob[COVARIANCE + axis])) * DEVIATION_STEPS;
    values[3 + axis] = Math.max(0, Math.min(65535, Math.round(steps) + DEVIATION_ZERO));
  }
  const [xx, yy, zz, xy, xz, yz] = blob.subarray(COVARIANCE);
  // Cholesky's decomposition. Rounding may leave a negative number under a root.
  const l00 = Math.sqrt(Math.max(1e-38, xx));
  const l10 = xy / l00;
  const l20 = xz / l00;
  const l11 = Math.sqrt(Math.max(0, yy - l10 * l10));
  const rest = Math.max(0, zz - l20 * l20);
  const across = Math.sqrt(rest);
  // Of flat blobs, l11 and what it divides are no more than rounding.
  const l21 = l11 > 0 ? Math.max(-across, Math.min(across, (yz - l10 * l20) / l11)) : 0;
  const l22 = Math.sqrt(Math.max(0, rest - l21 * l21));
  const angle = (y: number, x: number) => Math.round((Math.atan2(y, x) / Math.PI) * ANGLE_STEPS);
  values[6] = angle(l11, l10);
  values[7] = angle(across, l20);
  values[8] = angle(l22, l21);
  values[9] = Math.round((blob[OPACITY] / MOST_OPACITY) * 65535);
}
