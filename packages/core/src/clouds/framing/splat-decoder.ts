import { exp } from '../../data/framing/portable-math.ts';
import type { SplatSample } from '../../data/framing/splat-sample.ts';
import { GEOMETRY_WORDS, unpackRotation } from '../../data/packing/geometry.ts';
import type { SampledSplats } from './sampled-splats.ts';

/** Brings sampled splats to the world: the same numbers on every machine, bit for bit. */
export function decodeSamples(parts: readonly SampledSplats[], weight: number): SplatSample {
  const count = parts.reduce((sum, { instances }) => sum + instances.length, 0);
  const sample = {
    count,
    weight,
    positions: new Float64Array(3 * count),
    opacities: new Float32Array(count),
    sigmas: new Float32Array(3 * count),
    normals: new Float32Array(3 * count),
  };
  let first = 0;
  for (const part of parts) {
    decodePart(part, sample, first);
    first += part.instances.length;
  }
  return sample;
}

function decodePart(part: SampledSplats, sample: SplatSample, first: number): void {
  const { precision, words, logScales, instances, origin, matrices, opacities } = part;
  const stride = GEOMETRY_WORDS[precision];
  const floats = new Float32Array(words.buffer, words.byteOffset, words.length);
  const rotation = new Float64Array(4);
  const scales = new Float64Array(3);
  const axes = new Float64Array(9);
  const world = new Float64Array(9);
  const lengths = new Float64Array(3);
  for (let i = 0; i < instances.length; i++) {
    const at = stride * i;
    const m = matrices.subarray(16 * instances[i], 16 * instances[i] + 16);
    let opacity: number;
    if (precision === 'f32') {
      opacity = floats[at + 3];
      for (let k = 0; k < 4; k++) rotation[k] = floats[at + 4 + k];
      for (let k = 0; k < 3; k++) scales[k] = floats[at + 8 + k];
    } else {
      opacity = (words[at + 4] >>> 16) / 65535;
      unpackRotation(words[at + 6] >>> 16, words[at + 7], rotation);
      const [least, step] = [logScales[2 * i], logScales[2 * i + 1]];
      scales[0] = exp(least + step * (words[at + 5] & 0xffff));
      scales[1] = exp(least + step * (words[at + 5] >>> 16));
      scales[2] = exp(least + step * (words[at + 6] & 0xffff));
    }
    const target = 3 * (first + i);
    const x = origin[0] + floats[at];
    const y = origin[1] + floats[at + 1];
    const z = origin[2] + floats[at + 2];
    for (let row = 0; row < 3; row++)
      sample.positions[target + row] = m[row] * x + m[4 + row] * y + m[8 + row] * z + m[12 + row];
    // Blobs of streamed scenes may be more than opaque in their middle.
    sample.opacities[first + i] = Math.min(1, opacity) * opacities[instances[i]];
    writeAxes(rotation, axes);
    for (let axis = 0; axis < 3; axis++) {
      const [ax, ay, az] = [axes[3 * axis], axes[3 * axis + 1], axes[3 * axis + 2]];
      let length2 = 0;
      for (let row = 0; row < 3; row++) {
        const value = m[row] * ax + m[4 + row] * ay + m[8 + row] * az;
        world[3 * axis + row] = value;
        length2 += value * value;
      }
      lengths[axis] = scales[axis] * Math.sqrt(length2);
    }
    const shortest = indexOfLeast(lengths);
    writeNormal(world, shortest, sample.normals, target);
    lengths.sort();
    sample.sigmas.set(lengths, target);
  }
}

/** Writes the three columns of the matrix of a unit quaternion w, x, y, z. */
function writeAxes([w, x, y, z]: Float64Array, axes: Float64Array): void {
  axes[0] = 1 - 2 * (y * y + z * z);
  axes[1] = 2 * (x * y + w * z);
  axes[2] = 2 * (x * z - w * y);
  axes[3] = 2 * (x * y - w * z);
  axes[4] = 1 - 2 * (x * x + z * z);
  axes[5] = 2 * (y * z + w * x);
  axes[6] = 2 * (x * z + w * y);
  axes[7] = 2 * (y * z - w * x);
  axes[8] = 1 - 2 * (x * x + y * y);
}

/** Place of the least of three lengths; the first of several. */
function indexOfLeast([a, b, c]: Float64Array): number {
  if (a <= b && a <= c) return 0;
  return b <= c ? 1 : 2;
}

/**
 * Writes the unit normal of the plane of the other two axes, as uneven scales leave it, which is
 * along the third axis wherever scales are even.
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
