import { CHUNK_SPLATS } from '../layout/constants.ts';
import { clampCoefficient, toHalfBits } from '../layout/half.ts';
import { opacityOf } from '../splats/color-values.ts';
import type { SomeColumns, SplatColumns } from '../splats/splat-set.ts';
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
  const geometry = { precision, words: new Uint32Array(set.count * GEOMETRY_WORDS[precision]), chunks };
  putColumns(geometry, set);
  return geometry;
}

/** Packs some columns of all splats, and leaves the others as they are. */
export function putColumns({ precision, words, chunks }: PackedGeometry, columns: SomeColumns): void {
  const { count, positions, logScales, rotations, opacityLogits, colorDc } = columns;
  const isF32 = precision === 'f32';
  const floats = new Float32Array(words.buffer);
  const halves = new Uint16Array(words.buffer);
  const rotation = new Float64Array(4);
  let range = { min: 0, step: 0 };
  for (let i = 0; i < count; i++) {
    if (i % CHUNK_SPLATS === 0) range = logScalesOf(chunks, i / CHUNK_SPLATS);
    const at = GEOMETRY_WORDS[precision] * i;
    for (let axis = 0, from = 3 * i; axis < 3; axis++, from++) {
      if (positions) floats[at + axis] = positions[from];
      if (colorDc) {
        if (isF32) floats[at + 12 + axis] = clampCoefficient(colorDc[from]);
        else halves[2 * at + 6 + axis] = toHalfBits(colorDc[from]);
      }
      if (logScales) {
        if (isF32) floats[at + 8 + axis] = Math.exp(clampLogScale(logScales[from]));
        else halves[2 * at + 10 + axis] = logScaleSteps(logScales[from], range);
      }
    }
    if (opacityLogits) {
      const opacity = opacityOf(opacityLogits[i]);
      if (isF32) floats[at + 3] = opacity;
      else halves[2 * at + 9] = Math.round(opacity * 65535);
    }
    if (rotations) {
      normalizedRotation(rotations, 4 * i, rotation);
      if (isF32) floats.set(rotation, at + 4);
      else [halves[2 * at + 13], words[at + 7]] = packRotation(rotation);
    }
  }
}

/** Steps on either side of zero, so that zero itself, and with it the identity, is exact. */
export const ROTATION_STEPS = 16383;

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
