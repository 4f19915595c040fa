import { CHUNK_SPLATS } from '../../../data/layout/constants.ts';
import { clampCoefficient } from '../../../data/layout/half.ts';
import { chunkCountOf } from '../../../data/packing/chunks.ts';
import { type Harmonics, readCoefficients } from '../../../data/packing/harmonics.ts';
import { clampLogScale } from '../../../data/packing/log-scale.ts';
import { normalizedRotation } from '../../../data/packing/rotation.ts';
import { opacityOf } from '../../../data/splats/color-values.ts';
import { coefficientsPerSplat, type SplatSet } from '../../../data/splats/splat-set.ts';
import { type KeyFrame, rotationsOf } from './decode-frame.ts';
import type { FrameColumn } from './frame-columns.ts';
import {
  CHUNK_NUMBERS,
  COLOR_STEPS,
  COLUMN,
  columnCountOf,
  LOG_SCALE_STEPS,
  OPACITY_STEPS,
  ROTATION_STEPS,
} from './frames-layout.ts';

/** Positions have steps of this part of the size of a chunk's small splats, along their middle axis. */
const STEP_OF_SIZE = 1 / 32;
/** Part of a chunk's splats that may be smaller. */
const SMALLER_SPLATS = 0.1;
/** Most steps of a chunk's extent, and of its coordinates: float32 tells no more of them apart. */
const MOST_STEPS = 2 ** 24;
/** Most steps by which a splat may move away from its key frame. */
const MOST_MOVED = 2 ** 30;
/** Step of splats without a size that all lie at 0. */
const LEAST_STEP = 1e-30;

/** The key frame of splats in storage order. */
export function quantiseKey(set: SplatSet<Harmonics>): KeyFrame {
  const { count, origin, harmonics } = set;
  const key = { splatCount: count, shDegree: harmonics.degree, origin, chunks: chunksOf(set) };
  const columns = withoutZeros(quantised(set, key, null));
  return { ...key, columns, rotations: rotationsOf(columns, count) };
}

/**
 * The difference between a key frame and the splats of a later frame, in the same order. Null if a splat has
 * moved too far for the key frame's steps.
 */
export function quantiseDifference(set: SplatSet<Harmonics>, key: KeyFrame): readonly FrameColumn[] | null {
  const columns = quantised(set, key, key.rotations);
  for (const [i, column] of columns.entries()) {
    const before = isRotation(i) ? null : key.columns[i];
    for (let k = 0; before && k < before.length; k++) column[k] -= before[k];
    if (i < COLUMN.logScale && column.some((value) => !(Math.abs(value) <= MOST_MOVED))) return null;
  }
  return withoutZeros(columns);
}

/** Rotations alone are no differences of numbers. */
function isRotation(column: number): boolean {
  return column >= COLUMN.rotation && column < COLUMN.opacity;
}

function withoutZeros(columns: readonly Float64Array[]): FrameColumn[] {
  return columns.map((column) => (column.some((value) => value !== 0) ? Int32Array.from(column) : null));
}

/** Least corner and step of each chunk. */
function chunksOf({ count, positions, logScales }: SplatSet<Harmonics>): Float32Array<ArrayBuffer> {
  const chunks = new Float32Array(CHUNK_NUMBERS * chunkCountOf(count));
  for (let from = 0; from < count; from += CHUNK_SPLATS) {
    const to = Math.min(count, from + CHUNK_SPLATS);
    const at = (CHUNK_NUMBERS * from) / CHUNK_SPLATS;
    let [extent, farthest] = [0, 0];
    for (let axis = 0; axis < 3; axis++) {
      let [least, greatest] = [Number.POSITIVE_INFINITY, Number.NEGATIVE_INFINITY];
      for (let i = from; i < to; i++) {
        least = Math.min(least, positions[3 * i + axis]);
        greatest = Math.max(greatest, positions[3 * i + axis]);
      }
      chunks[at + axis] = least;
      extent = Math.max(extent, greatest - least);
      farthest = Math.max(farthest, Math.abs(least), Math.abs(greatest));
    }
    const sizes = Float64Array.from({ length: to - from }, (_, i) => middleSize(logScales, from + i)).sort();
    const small = sizes[Math.floor(SMALLER_SPLATS * sizes.length)];
    const step = Math.max(STEP_OF_SIZE * small, extent / MOST_STEPS, farthest / MOST_STEPS, LEAST_STEP);
    chunks[at + 3] = step;
  }
  return chunks;
}

/** Standard deviation along the middle axis: flat splats are no reason for finer steps. */
function middleSize(logScales: Float32Array, i: number): number {
  const [a, b, c] = [logScales[3 * i], logScales[3 * i + 1], logScales[3 * i + 2]];
  return Math.exp(clampLogScale(Math.max(Math.min(a, b), Math.min(Math.max(a, b), c))));
}

/**
 * All columns, in steps; positions and rotations relative to `key`.
 *
 * @param before rotations of the key frame; null for a key frame.
 */
function quantised(
  set: SplatSet<Harmonics>,
  { origin, chunks }: Pick<KeyFrame, 'origin' | 'chunks'>,
  before: Float64Array | null,
): Float64Array[] {
  const { count, harmonics } = set;
  const width = coefficientsPerSplat(harmonics.degree);
  const columns = Array.from(
    { length: columnCountOf(harmonics.degree) },
    // Float64, because steps of a splat that has moved far exceed 32 bits.
    () => new Float64Array(count),
  );
  const [rotation, vector, coefficients] = [
    new Float64Array(4),
    new Float64Array(3),
    new Float64Array(width),
  ];
  const shift = origin.map((value, axis) => set.origin[axis] - value);
  for (let i = 0; i < count; i++) {
    const chunk = CHUNK_NUMBERS * Math.floor(i / CHUNK_SPLATS);
    normalizedRotation(set.rotations, 4 * i, rotation);
    rotationVector(rotation, before, 4 * i, vector);
    for (let axis = 0; axis < 3; axis++) {
      const moved = set.positions[3 * i + axis] + shift[axis] - chunks[chunk + axis];
      columns[COLUMN.position + axis][i] = Math.round(moved / chunks[chunk + 3]);
      columns[COLUMN.logScale + axis][i] = Math.round(
        clampLogScale(set.logScales[3 * i + axis]) * LOG_SCALE_STEPS,
      );
      columns[COLUMN.rotation + axis][i] = Math.round(vector[axis] * ROTATION_STEPS);
      columns[COLUMN.colorDc + axis][i] = colorSteps(set.colorDc[3 * i + axis]);
    }
    columns[COLUMN.opacity][i] = Math.round(opacityOf(set.opacityLogits[i]) * OPACITY_STEPS);
    if (width > 0) readCoefficients(harmonics, i, coefficients);
    for (let k = 0; k < width; k++) columns[COLUMN.harmonics + k][i] = colorSteps(coefficients[k]);
  }
  return columns;
}

function colorSteps(coefficient: number): number {
  return Math.round(clampCoefficient(coefficient) * COLOR_STEPS);
}

/** Writes the turn from a rotation of the key frame to `rotation`, in the former's axes, as a vector in radians. */
function rotationVector(
  [w, x, y, z]: Float64Array,
  before: Float64Array | null,
  at: number,
  vector: Float64Array,
): void {
  const [a, b, c, d] = before ? before.subarray(at, at + 4) : [1, 0, 0, 0];
  const cosine = a * w + b * x + c * y + d * z;
  // A quaternion and its negative are the same rotation: the shorter turn of both.
  const sign = cosine < 0 ? -1 : 1;
  vector[0] = sign * (a * x - b * w - c * z + d * y);
  vector[1] = sign * (a * y - c * w - d * x + b * z);
  vector[2] = sign * (a * z - d * w - b * y + c * x);
  const sine = Math.hypot(vector[0], vector[1], vector[2]);
  const angle = 2 * Math.atan2(sine, Math.abs(cosine));
  for (let axis = 0; axis < 3; axis++) vector[axis] *= sine > 0 ? angle / sine : 0;
}
