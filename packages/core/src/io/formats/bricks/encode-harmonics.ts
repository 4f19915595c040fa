import type { Brick } from '../../../data/bricks/brick.ts';
import { principalAxes } from '../../../data/math/principal-axes.ts';
import { type PackedHarmonics, readCoefficients, shWordsPerSplat } from '../../../data/packing/harmonics.ts';
import { BLOB_PRECISION } from '../../../data/packing/precision.ts';
import { coefficientsPerSplat, type ShDegree } from '../../../data/splats/splat-set.ts';
import {
  AXIS_STEPS,
  COMPONENT_BYTES,
  HARMONICS_HEAD_BYTES,
  HARMONICS_STEP,
  IS_DIFFERENCE,
  IS_WIDE,
  MOST_HARMONICS_STEPS,
  ROUNDED_UP,
} from './bricks-layout.ts';
import { PlaneWriter, zigzag } from './planes.ts';

/** Differences are written if their variance is below this fraction of the values' variance. */
const LEAST_GAIN = 0.9;

/**
 * Encodes the harmonics of a brick of degree 1 or above as rounded bytes: see bricks-layout.ts.
 * Principal components capture the common part of neighbouring splats. Components smaller than the
 * rounding error are left out.
 */
export function encodeHarmonics(
  { cells, harmonics: words }: Brick,
  degree: ShDegree,
): Uint8Array<ArrayBuffer> {
  const count = cells.reduce((sum, { leafCount }) => sum + leafCount, 0);
  const width = coefficientsPerSplat(degree);
  const precision = BLOB_PRECISION.shPrecision;
  const packed: PackedHarmonics = {
    degree,
    precision,
    wordsPerSplat: shWordsPerSplat(degree, precision),
    words,
  };
  const rests = new Float64Array(count * width);
  for (let i = 0; i < count; i++) readCoefficients(packed, i, rests.subarray(i * width, (i + 1) * width));
  const means = subtractMeans(rests, count, width);
  let largest = 0;
  for (let i = 0; i < count; i++) {
    let squares = 0;
    for (let k = i * width; k < (i + 1) * width; k++) squares += rests[k] * rests[k];
    largest = Math.max(largest, squares);
  }
  const step = Math.fround(Math.max(HARMONICS_STEP, Math.sqrt(largest) / MOST_HARMONICS_STEPS));
  const components: Component[] = [];
  const axes = principalAxes(covarianceOf(rests, count, width), width);
  for (let at = 0; at < axes.length; at += width) {
    const component = componentOf(axes.subarray(at, at + width), rests, count, step);
    if (component) components.push(component);
  }
  const componentBytes = COMPONENT_BYTES + width;
  const firstComponent = HARMONICS_HEAD_BYTES + 4 * width;
  const planeCount = components.reduce((sum, { flags }) => sum + (flags & IS_WIDE ? 2 : 1), 0);
  const planes = new PlaneWriter(count, firstComponent + components.length * componentBytes, planeCount);
  const head = new DataView(planes.bytes.buffer);
  head.setUint8(0, components.length);
  for (let k = 0; k < width; k++) head.setFloat32(HARMONICS_HEAD_BYTES + 4 * k, means[k], true);
  for (const [i, { axis, length, flags, values }] of components.entries()) {
    const at = firstComponent + i * componentBytes;
    head.setUint8(at, flags);
    head.setFloat32(at + 1, length, true);
    for (let k = 0; k < width; k++) head.setInt8(at + COMPONENT_BYTES + k, axis[k]);
    if (flags & IS_WIDE) planes.wide((leaf) => values[leaf]);
    else planes.narrow((leaf) => values[leaf]);
  }
  return planes.bytes;
}

interface Component {
  /** Integers, the largest of magnitude AXIS_STEPS. */
  readonly axis: Int8Array;
  /** Change of a coefficient per step of the axis, for a value of one step. */
  readonly length: number;
  readonly flags: number;
  /** Encoded values, one per leaf. */
  readonly values: Uint16Array;
}

/** Subtracts the means from `rests`, and returns them. */
function subtractMeans(rests: Float64Array, count: number, width: number): Float32Array {
  const sums = new Float64Array(width);
  for (let i = 0; i < rests.length; i++) sums[i % width] += rests[i];
  const means = Float32Array.from(sums, (sum) => sum / count);
  for (let i = 0; i < rests.length; i++) rests[i] -= means[i % width];
  return means;
}

function covarianceOf(rests: Float64Array, count: number, width: number): Float64Array {
  // Column sums stay in registers; the order of additions is fixed.
  const columns = new Float64Array(rests.length);
  for (let i = 0; i < count; i++)
    for (let k = 0; k < width; k++) columns[k * count + i] = rests[i * width + k];
  const covariance = new Float64Array(width * width);
  for (let k = 0; k < width; k++) {
    // Three at a time cost as much as one: additions wait for their predecessors.
    for (let l = k - (k % 3); l < width; l += 3) {
      const [own, first, second, third] = [k * count, l * count, (l + 1) * count, (l + 2) * count];
      let [a, b, c] = [0, 0, 0];
      for (let i = 0; i < count; i++) {
        const value = columns[own + i];
        a += value * columns[first + i];
        b += value * columns[second + i];
        c += value * columns[third + i];
      }
      covariance[k * width + l] = a / count;
      covariance[k * width + l + 1] = b / count;
      covariance[k * width + l + 2] = c / count;
    }
    for (let l = 0; l < k; l++) covariance[k * width + l] = covariance[l * width + k];
  }
  return covariance;
}

/** Subtracts the projection on an axis from `rests`; null if the projection is smaller than rounding. */
function componentOf(
  exact: Float64Array,
  rests: Float64Array,
  count: number,
  step: number,
): Component | null {
  const width = exact.length;
  let largest = 0;
  for (const value of exact) largest = Math.max(largest, Math.abs(value));
  const axis = Int8Array.from(exact, (value) => Math.round((AXIS_STEPS * value) / largest));
  const axisLength = Math.sqrt(axis.reduce((sum, value) => sum + value * value, 0));
  const values = new Int16Array(count);
  // Float64, to avoid a conversion at each use.
  const weights = Float64Array.from(axis);
  const alongs = projections(weights, rests, count);
  let squares = 0;
  let isZero = true;
  for (let i = 0; i < count; i++) {
    const along = alongs[i] / axisLength;
    squares += along * along;
    values[i] = Math.sign(along) * Math.floor(Math.abs(along) / step + 1 - ROUNDED_UP);
    if (values[i] !== 0) isZero = false;
  }
  // Rounding has a variance of step² / 12.
  if (isZero || squares / count < (step * step) / 6) return null;
  const length = Math.fround(step / axisLength);
  for (let i = 0; i < count; i++) {
    if (values[i] === 0) continue;
    const along = length * values[i];
    for (let k = 0; k < width; k++) rests[i * width + k] -= along * weights[k];
  }
  return { axis, length, ...written(values) };
}

/** The dot product of each leaf's coefficients and an axis. */
function projections(weights: Float64Array, rests: Float64Array, count: number): Float64Array {
  const width = weights.length;
  const sums = new Float64Array(count);
  let i = 0;
  // Four at a time cost as much as one: additions wait for their predecessors.
  for (; i + 4 <= count; i += 4) {
    const at = i * width;
    let [a, b, c, d] = [0, 0, 0, 0];
    for (let k = 0; k < width; k++) {
      const weight = weights[k];
      a += weight * rests[at + k];
      b += weight * rests[at + width + k];
      c += weight * rests[at + 2 * width + k];
      d += weight * rests[at + 3 * width + k];
    }
    sums[i] = a;
    sums[i + 1] = b;
    sums[i + 2] = c;
    sums[i + 3] = d;
  }
  for (; i < count; i++) for (let k = 0; k < width; k++) sums[i] += weights[k] * rests[i * width + k];
  return sums;
}

/** Encodes the values directly, or as differences if neighbours are alike. */
function written(steps: Int16Array): Pick<Component, 'flags' | 'values'> {
  let squares = 0;
  let squaredDifferences = 0;
  let before = 0;
  for (let i = 0; i < steps.length; i++) {
    const [value, difference] = [steps[i], steps[i] - before];
    squares += value * value;
    squaredDifferences += difference * difference;
    before = value;
  }
  const isDifference = squaredDifferences < LEAST_GAIN * squares;
  const values = new Uint16Array(steps.length);
  let isWide = false;
  before = 0;
  for (let i = 0; i < steps.length; i++) {
    values[i] = zigzag(isDifference ? steps[i] - before : steps[i]);
    if (values[i] > 255) isWide = true;
    before = steps[i];
  }
  return { values, flags: (isWide ? IS_WIDE : 0) | (isDifference ? IS_DIFFERENCE : 0) };
}
