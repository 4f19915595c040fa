import { writeRotationMatrix } from '../data/math/rotation-matrix.ts';
import { emptySplat, splatReader } from '../data/packing/unpack-geometry.ts';
import { exp } from './portable-math.ts';
import type { SampledSplats, SplatSample } from './samples.ts';

/**
 * Transforms sampled splats to world space and drops fully transparent ones. The results are
 * bit-identical on every machine.
 */
export function decodeSamples(parts: readonly SampledSplats[], weight: number): SplatSample {
  const most = parts.reduce((sum, { instances }) => sum + instances.length, 0);
  const columns = {
    positions: new Float64Array(3 * most),
    opacities: new Float32Array(most),
    sigmas: new Float32Array(3 * most),
    normals: new Float32Array(3 * most),
    colors: new Float32Array(3 * most),
  };
  let count = 0;
  for (const part of parts) count = decodePart(part, columns, count);
  return {
    count,
    weight,
    positions: columns.positions.subarray(0, 3 * count),
    opacities: columns.opacities.subarray(0, count),
    sigmas: columns.sigmas.subarray(0, 3 * count),
    normals: columns.normals.subarray(0, 3 * count),
    colors: columns.colors.subarray(0, 3 * count),
  };
}

type Columns = Pick<SplatSample, 'positions' | 'opacities' | 'sigmas' | 'normals' | 'colors'>;

/** Appends the splats of a part after the first `count`; returns the new count. */
function decodePart(part: SampledSplats, columns: Columns, count: number): number {
  const { precision, words, logScales, instances, origin, matrices, opacities } = part;
  const rangeOf = (i: number) => ({ min: logScales[2 * i], step: logScales[2 * i + 1] });
  const read = splatReader({ precision, words }, rangeOf, exp);
  const splat = emptySplat();
  const axes = new Float64Array(9);
  const world = new Float64Array(9);
  const lengths = new Float64Array(3);
  const [originX, originY, originZ] = origin;
  const { positions, sigmas, normals, colors } = columns;
  for (let i = 0; i < instances.length; i++) {
    const m = 16 * instances[i];
    read(i, splat);
    // Blobs of streamed scenes may have an opacity above 1.
    const opacity = Math.min(1, splat.opacity) * opacities[instances[i]];
    if (!(opacity > 0)) continue;
    const target = 3 * count;
    colors.set(splat.colorDc, target);
    const x = originX + splat.position[0];
    const y = originY + splat.position[1];
    const z = originZ + splat.position[2];
    writeRotationMatrix(splat.rotation, axes);
    for (let row = 0; row < 3; row++) {
      const [mx, my, mz] = [matrices[m + row], matrices[m + 4 + row], matrices[m + 8 + row]];
      positions[target + row] = mx * x + my * y + mz * z + matrices[m + 12 + row];
      for (let axis = 0; axis < 9; axis += 3)
        world[axis + row] = mx * axes[axis] + my * axes[axis + 1] + mz * axes[axis + 2];
    }
    columns.opacities[count] = opacity;
    for (let axis = 0; axis < 3; axis++) {
      const [ax, ay, az] = [world[3 * axis], world[3 * axis + 1], world[3 * axis + 2]];
      lengths[axis] = splat.scale[axis] * Math.sqrt(ax * ax + ay * ay + az * az);
    }
    writeNormal(world, placeOfLeast(lengths), normals, target);
    writeAscending(lengths, sigmas, target);
    count++;
  }
  return count;
}

/** Index of the least of three lengths; the first of equal ones. */
function placeOfLeast(lengths: Float64Array): number {
  const least = lengths[1] < lengths[0] ? 1 : 0;
  return lengths[2] < lengths[least] ? 2 : least;
}

function writeAscending(lengths: Float64Array, sigmas: Float32Array, at: number): void {
  const [a, b, c] = [lengths[0], lengths[1], lengths[2]];
  const least = Math.min(a, b, c);
  const largest = Math.max(a, b, c);
  sigmas[at] = least;
  sigmas[at + 1] = Math.max(Math.min(a, b), Math.min(Math.max(a, b), c));
  sigmas[at + 2] = largest;
}

/**
 * Writes the unit normal of the plane that the other two axes span. Under uneven scales it differs
 * from the third axis.
 */
function writeNormal(axes: Float64Array, third: number, normals: Float32Array, at: number): void {
  const a = 3 * ((third + 1) % 3);
  const b = 3 * ((third + 2) % 3);
  const x = axes[a + 1] * axes[b + 2] - axes[a + 2] * axes[b + 1];
  const y = axes[a + 2] * axes[b] - axes[a] * axes[b + 2];
  const z = axes[a] * axes[b + 1] - axes[a + 1] * axes[b];
  const length = Math.sqrt(x * x + y * y + z * z);
  // A matrix that flattens the scene to a line or a point leaves no plane.
  const isPlane = length > 0 && length < Number.POSITIVE_INFINITY;
  normals[at] = isPlane ? x / length : 0;
  normals[at + 1] = isPlane ? y / length : 0;
  normals[at + 2] = isPlane ? z / length : 1;
}
