import { CHUNK_SPLATS } from '../data/layout/constants.ts';
import { fromHalfBits } from '../data/layout/half.ts';
import { logScalesOf } from '../data/packing/chunks.ts';
import { GEOMETRY_WORDS, type PackedGeometry } from '../data/packing/geometry.ts';

/** Geometry and base colour of a splat as the GPU unpacks them, in the cloud's space. */
export interface ReferenceSplat {
  readonly position: readonly [number, number, number];
  /** Peak opacity, 0…1. */
  readonly opacity: number;
  /** Unit quaternion w, x, y, z. */
  readonly rotation: readonly [number, number, number, number];
  /** Standard deviation along each local axis. */
  readonly scale: readonly [number, number, number];
  /** Spherical-harmonics coefficients of degree 0. */
  readonly colorDc: readonly [number, number, number];
}

/** Reference of shaders/lib/packing.wgsl, in float64: splat `index` of `geometry`. */
export function unpackSplat({ precision, words, chunks }: PackedGeometry, index: number): ReferenceSplat {
  const at = index * GEOMETRY_WORDS[precision];
  const v = words.subarray(at, at + GEOMETRY_WORDS[precision]);
  const f = new Float32Array(words.buffer, words.byteOffset + 4 * at, v.length);
  const position = [f[0], f[1], f[2]] as const;
  if (precision === 'f32') {
    return {
      position,
      opacity: f[3],
      rotation: [f[4], f[5], f[6], f[7]],
      scale: [f[8], f[9], f[10]],
      colorDc: [f[12], f[13], f[14]],
    };
  }
  const { min, step } = logScalesOf(chunks, Math.floor(index / CHUNK_SPLATS));
  const scaleOf = (steps: number) => Math.exp(min + step * steps);
  return {
    position,
    opacity: (v[4] >>> 16) / 65535,
    rotation: unpackRotation(v[6] >>> 16, v[7]),
    scale: [scaleOf(v[5] & 0xffff), scaleOf(v[5] >>> 16), scaleOf(v[6] & 0xffff)],
    colorDc: [fromHalfBits(v[3] & 0xffff), fromHalfBits(v[3] >>> 16), fromHalfBits(v[4] & 0xffff)],
  };
}

/** Smallest-three: the largest component is positive and omitted, others 15-bit steps in ±√½. */
function unpackRotation(low: number, high: number): [number, number, number, number] {
  const largest = (low >>> 15) | (((high >>> 15) & 1) << 1);
  const rest = [low & 0x7fff, high & 0x7fff, (high >>> 16) & 0x7fff].map(
    (step) => ((step - 16383) * Math.SQRT1_2) / 16383,
  );
  const left = Math.sqrt(Math.max(0, 1 - rest[0] ** 2 - rest[1] ** 2 - rest[2] ** 2));
  rest.splice(largest, 0, left);
  return rest as [number, number, number, number];
}
