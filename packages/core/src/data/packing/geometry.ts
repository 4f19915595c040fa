import { CHUNK_SPLATS } from '../layout/constants.ts';
import { clampCoefficient, toHalfBits } from '../layout/half.ts';
import { opacityOf } from '../splats/color-values.ts';
import type { SplatColumns } from '../splats/splat-set.ts';
import { chunksOf, logScalesOf } from './chunks.ts';
import { clampLogScale, logScaleSteps } from './log-scale.ts';
import type { GeometryPrecision } from './precision.ts';
import { largestComponent, normalizedRotation } from './rotation.ts';

/** 32-bit words per splat, as in shaders/lib/packing.wgsl. */
export const GEOMETRY_WORDS: Readonly<Record<GeometryPrecision, number>> = { f32: 16, packed: 8 };

/** Geometry, base colour and opacity of N splats, GEOMETRY_WORDS words each, as on the GPU. */
export interface PackedGeometry {
  readonly precision: GeometryPrecision;
  readonly words: Uint32Array;
  /** Words of the `Chunk` structs of the splats. */
  readonly chunks: Float32Array<ArrayBuffer>;
}

/**
 * Packs all splats of `set`, in its order.
 *
 * f32, 64 bytes: position, opacity | rotation w, x, y, z | scale, 0 | dc, 0.
 *
 * packed, 32 bytes: position 3×f32 | dc 3×f16 | opacity unorm16 | log scale 3×unorm16 over the
 * chunk's range | rotation smallest-three, 3×15 bits and the 2-bit index of the one left out (bit
 * 15 of the first and second).
 *
 * @param chunks default: the chunks of `set`.
 */
export function packGeometry(
  set: SplatColumns,
  precision: GeometryPrecision,
  chunks = chunksOf(set),
): PackedGeometry {
  const words = new Uint32Array(set.count * GEOMETRY_WORDS[precision]);
  if (precision === 'f32') packF32(set, new Float32Array(words.buffer));
  else packSmall(set, words, chunks);
  return { precision, words, chunks };
}

function packF32(set: SplatColumns, target: Float32Array): void {
  const rotation = new Float64Array(4);
  for (let i = 0; i < set.count; i++) {
    const at = 16 * i;
    normalizedRotation(set.rotations, 4 * i, rotation);
    for (let axis = 0; axis < 3; axis++) {
      target[at + axis] = set.positions[3 * i + axis];
      target[at + 8 + axis] = Math.exp(clampLogScale(set.logScales[3 * i + axis]));
      target[at + 12 + axis] = clampCoefficient(set.colorDc[3 * i + axis]);
    }
    target[at + 3] = opacityOf(set.opacityLogits[i]);
    target.set(rotation, at + 4);
  }
}

function packSmall(set: SplatColumns, words: Uint32Array, chunks: Float32Array): void {
  const positionBits = new Uint32Array(set.positions.buffer, set.positions.byteOffset, 3 * set.count);
  const rotation = new Float64Array(4);
  let range = { min: 0, step: 0 };
  for (let i = 0; i < set.count; i++) {
    if (i % CHUNK_SPLATS === 0) range = logScalesOf(chunks, i / CHUNK_SPLATS);
    const at = 8 * i;
    words[at] = positionBits[3 * i];
    words[at + 1] = positionBits[3 * i + 1];
    words[at + 2] = positionBits[3 * i + 2];
    words[at + 3] = toHalfBits(set.colorDc[3 * i]) | (toHalfBits(set.colorDc[3 * i + 1]) << 16);
    const opacity = Math.round(opacityOf(set.opacityLogits[i]) * 65535);
    words[at + 4] = toHalfBits(set.colorDc[3 * i + 2]) | (opacity << 16);
    const scaleX = logScaleSteps(set.logScales[3 * i], range);
    const scaleY = logScaleSteps(set.logScales[3 * i + 1], range);
    const scaleZ = logScaleSteps(set.logScales[3 * i + 2], range);
    normalizedRotation(set.rotations, 4 * i, rotation);
    const [low, high] = packRotation(rotation);
    words[at + 5] = scaleX | (scaleY << 16);
    words[at + 6] = scaleZ | (low << 16);
    words[at + 7] = high;
  }
}

/** Steps on either side of zero, so that zero itself, and with it the identity, is exact. */
const ROTATION_STEPS = 16383;

/** Result of `packRotation`, overwritten by each call: an array of its own would take half its time. */
const packedRotation: [low: number, high: number] = [0, 0];

/** The half-word and the word of a unit quaternion; valid until the next call. */
export function packRotation(rotation: Float64Array): readonly [low: number, high: number] {
  const largest = largestComponent(rotation);
  // A quaternion and its negative are the same rotation: the one left out is made positive.
  const sign = rotation[largest] < 0 ? -1 : 1;
  const steps = (k: number) => Math.round(sign * rotation[k] * Math.SQRT2 * ROTATION_STEPS) + ROTATION_STEPS;
  const first = steps(largest === 0 ? 1 : 0);
  const second = steps(largest <= 1 ? 2 : 1);
  const third = steps(largest === 3 ? 2 : 3);
  packedRotation[0] = first | ((largest & 1) << 15);
  packedRotation[1] = second | ((largest >> 1) << 15) | (third << 16);
  return packedRotation;
}

/** Writes the unit quaternion of two half-words and a word as `packRotation` makes them. */
export function unpackRotation(low: number, high: number, rotation: Float64Array): void {
  const largest = (low >>> 15) | (((high >>> 15) & 1) << 1);
  let left = 1;
  let place = 0;
  for (let k = 0; k < 4; k++) {
    if (k === largest) continue;
    const steps = place === 0 ? low & 0x7fff : place === 1 ? high & 0x7fff : (high >>> 16) & 0x7fff;
    rotation[k] = ((steps - ROTATION_STEPS) * Math.SQRT1_2) / ROTATION_STEPS;
    left -= rotation[k] * rotation[k];
    place++;
  }
  rotation[largest] = Math.sqrt(Math.max(0, left));
}
