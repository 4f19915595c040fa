import type { Vec3 } from '../data/math/mat4.ts';
import { selectValue } from '../data/math/select-value.ts';
import type { SplatSample } from './samples.ts';
import { weightedQuantile, weightedQuantiles } from './weighted-quantile.ts';

/** Splats fainter than this, or than half of them in a faint scene, tell nothing. */
const LEAST_OPACITY = 0.02;
/** Sides of the cells whose mean colours splats are compared with, and their number along an axis. */
const CONTRAST_CELL = 0.25;
const CONTRAST_CELLS = 32;
const MOST_CONTRAST = 4;
/** Interest of splats whose colour equals their surroundings. */
const LEAST_INTEREST = 0.3;
/**
 * Detail farther away than so many times the reach of four fifths of it is left out: failed splats that are
 * piled up at one point may be more than a twentieth of the detail. Of 87 captures none reached beyond 2.1.
 */
const FAR = 2.5;
/** Steps of Weiszfeld's method, which begins at the median of each axis. */
const MEDIAN_STEPS = 6;

/**
 * Where a scene has its detail. Training puts small splats near the cameras, so their density shows
 * where people took pictures. Extents, areas and volumes are dominated by the sky.
 *
 * Lengths and positions are in units of `scale` about `center`: half of the detail is within 1.
 */
export interface SceneDetail {
  readonly count: number;
  /** See `SplatSample`. */
  readonly weight: number;
  /** Geometric median of the detail, world space. */
  readonly center: Vec3;
  /** World units within which half of the detail lies about the centre. */
  readonly scale: number;
  /** N each. */
  readonly x: Float64Array;
  readonly y: Float64Array;
  readonly z: Float64Array;
  readonly opacities: Float32Array;
  /** 3N each: ascending standard deviations; unit vectors along the shortest axis. */
  readonly sigmas: Float32Array;
  readonly normals: Float32Array;
  /** N: distances from the centre. */
  readonly distances: Float64Array;
  /** N: detail of a splat: its opacity, less for large splats. */
  readonly details: Float64Array;
  /** N: `details`, reduced far from the centre. */
  readonly nearDetails: Float64Array;
  /** N: `nearDetails`, raised where colour differs from its neighbourhood: faces, writing, pictures. */
  readonly interests: Float64Array;
  /** Four fifths of the detail lie within this distance. */
  readonly reach: number;
  /** Nineteen twentieths of the detail lie within this distance, which is at most `FAR` times `reach`. */
  readonly farReach: number;
}

/** The detail of a sample; null if it has no splat that can be seen. */
export function sceneDetail(sample: SplatSample): SceneDetail | null {
  const rows = visibleRows(sample);
  const count = rows.length;
  if (count === 0) return null;
  const opacities = pick(sample.opacities, rows, new Float32Array(count), 1);
  const sigmas = pick(sample.sigmas, rows, new Float32Array(3 * count), 3);
  const normals = pick(sample.normals, rows, new Float32Array(3 * count), 3);
  const positions = pick(sample.positions, rows, new Float64Array(3 * count), 3);
  const [x, y, z] = [0, 1, 2].map((axis) => {
    const values = new Float64Array(count);
    for (let i = 0; i < count; i++) values[i] = positions[3 * i + axis];
    return values;
  });
  const details = detailsOf(opacities, sigmas);
  const center = geometricMedian([x, y, z], details);
  for (const [axis, values] of [x, y, z].entries()) for (let i = 0; i < count; i++) values[i] -= center[axis];
  const distances = new Float64Array(count);
  for (let i = 0; i < count; i++) distances[i] = Math.sqrt(x[i] * x[i] + y[i] * y[i] + z[i] * z[i]);
  // Splats at one point have no distances, but sizes.
  const scale = weightedQuantile(distances, details, count, 0.5) || 2 * medianOf(sigmas) || 1;
  for (const values of [x, y, z, distances, sigmas])
    for (let i = 0; i < values.length; i++) values[i] /= scale;
  const nearDetails = details.map((detail, i) => detail / (1 + distances[i] * distances[i]));
  const colors = pick(sample.colors, rows, new Float32Array(3 * count), 3);
  const contrasts = contrastsOf([x, y, z], colors, details);
  const interests = nearDetails.map((detail, i) => detail * (LEAST_INTEREST + contrasts[i]));
  const [reach, mostReach] = weightedQuantiles(distances, details, count, [0.8, 0.95]);
  const farReach = Math.min(mostReach, FAR * reach);
  return {
    count,
    weight: sample.weight,
    center,
    scale,
    x,
    y,
    z,
    opacities,
    sigmas,
    normals,
    distances,
    details,
    nearDetails,
    interests,
    reach,
    farReach,
  };
}

/**
 * How far colours are from the mean colour of the splats around, divided by the mean of these distances; at
 * most MOST_CONTRAST.
 */
function contrastsOf(
  axes: readonly Float64Array[],
  colors: Float32Array,
  details: Float64Array,
): Float64Array {
  const count = details.length;
  const cells = new Uint16Array(count);
  const half = CONTRAST_CELLS / 2;
  for (let i = 0; i < count; i++) {
    let cell = 0;
    for (const values of axes) {
      const place = Math.floor(values[i] / CONTRAST_CELL) + half;
      cell = cell * CONTRAST_CELLS + Math.min(CONTRAST_CELLS - 1, Math.max(0, place));
    }
    cells[i] = cell;
  }
  const sums = new Float64Array(4 * CONTRAST_CELLS * CONTRAST_CELLS * CONTRAST_CELLS);
  for (let i = 0; i < count; i++) {
    const at = 4 * cells[i];
    for (let channel = 0; channel < 3; channel++) sums[at + channel] += details[i] * colors[3 * i + channel];
    sums[at + 3] += details[i];
  }
  const contrasts = new Float64Array(count);
  let total = 0;
  let weight = 0;
  for (let i = 0; i < count; i++) {
    const at = 4 * cells[i];
    for (let channel = 0; channel < 3; channel++)
      contrasts[i] += Math.abs(colors[3 * i + channel] - sums[at + channel] / sums[at + 3]);
    total += details[i] * contrasts[i];
    weight += details[i];
  }
  if (!(total > 0)) return contrasts.fill(1);
  for (let i = 0; i < count; i++) contrasts[i] = Math.min(MOST_CONTRAST, (contrasts[i] * weight) / total);
  return contrasts;
}

/** Values of these rows, `per` of each. */
function pick<Values extends Float32Array | Float64Array>(
  values: Values,
  rows: Uint32Array,
  picked: Values,
  per: number,
): Values {
  for (let i = 0; i < rows.length; i++)
    for (let k = 0; k < per; k++) picked[per * i + k] = values[per * rows[i] + k];
  return picked;
}

function visibleRows({ count, positions, opacities, sigmas }: SplatSample): Uint32Array {
  const rows = new Uint32Array(count);
  const least = count > 0 ? Math.min(LEAST_OPACITY, medianOf(opacities)) : 0;
  let kept = 0;
  for (let i = 0; i < count; i++) {
    const sum = positions[3 * i] + positions[3 * i + 1] + positions[3 * i + 2];
    if (
      opacities[i] >= least &&
      opacities[i] > 0 &&
      Number.isFinite(sum) &&
      Number.isFinite(sigmas[3 * i + 2])
    )
      rows[kept++] = i;
  }
  return rows.subarray(0, kept);
}

function detailsOf(opacities: Float32Array, sigmas: Float32Array): Float64Array {
  const sizes = new Float64Array(opacities.length);
  for (let i = 0; i < sizes.length; i++) sizes[i] = Math.sqrt(sigmas[3 * i + 1] * sigmas[3 * i + 2]);
  const median = medianOf(sizes);
  const details = new Float64Array(sizes.length);
  for (let i = 0; i < sizes.length; i++)
    details[i] = sizes[i] > median ? (opacities[i] * median) / sizes[i] : opacities[i];
  return details;
}

function medianOf(values: Float32Array | Float64Array): number {
  return selectValue(values.slice(), values.length >>> 1);
}

/** The point with the least sum of weighted distances: up to half of all weight may be astray. */
function geometricMedian(axes: readonly Float64Array[], weights: Float64Array): Vec3 {
  const [x, y, z] = axes;
  let [cx, cy, cz] = axes.map(medianOf);
  for (let step = 0; step < MEDIAN_STEPS; step++) {
    let [sum, sumX, sumY, sumZ] = [0, 0, 0, 0];
    for (let i = 0; i < x.length; i++) {
      const dx = x[i] - cx;
      const dy = y[i] - cy;
      const dz = z[i] - cz;
      const distance = Math.sqrt(dx * dx + dy * dy + dz * dz);
      if (distance === 0) continue;
      const pull = weights[i] / distance;
      sum += pull;
      sumX += pull * dx;
      sumY += pull * dy;
      sumZ += pull * dz;
    }
    if (!(sum > 0)) break;
    cx += sumX / sum;
    cy += sumY / sum;
    cz += sumZ / sum;
  }
  return [cx, cy, cz];
}
