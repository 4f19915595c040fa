import { fromHalfBits } from '../layout/half.ts';
import { GEOMETRY_WORDS, type PackedGeometry, ROTATION_STEPS } from './geometry.ts';
import type { LogScaleRange } from './log-scale.ts';

/** One splat as drawn; read again and again into the same arrays. */
export interface UnpackedSplat<Values extends Float64Array | Float32Array = Float64Array> {
  readonly position: Values;
  /** Above 1 for blobs that stand for splats on top of each other. */
  opacity: number;
  /** Unit quaternion w, x, y, z. */
  readonly rotation: Values;
  /** Standard deviation along each local axis. */
  readonly scale: Values;
  readonly colorDc: Values;
}

export function emptySplat(): UnpackedSplat {
  const [position, rotation, scale, colorDc] = [3, 4, 3, 3].map((length) => new Float64Array(length));
  return { position, opacity: 0, rotation, scale, colorDc };
}

/**
 * Returns a function that reads splat `index` as shaders unpack it; `packGeometry` has the layout. The
 * reference, `reference/packing.ts`, is written apart from it.
 *
 * @param rangeOf range of log scales of splat `index`; called for packed geometry.
 * @param exp `Math.exp`, or one that is the same on every machine.
 */
export function splatReader(
  { precision, words }: Pick<PackedGeometry, 'precision' | 'words'>,
  rangeOf: (index: number) => LogScaleRange,
  exp = Math.exp,
): (index: number, splat: UnpackedSplat) => void {
  const floats = new Float32Array(words.buffer, words.byteOffset, words.length);
  return (index, splat) => {
    const at = index * GEOMETRY_WORDS[precision];
    const { position, rotation, scale, colorDc } = splat;
    for (let axis = 0; axis < 3; axis++) position[axis] = floats[at + axis];
    if (precision === 'f32') {
      splat.opacity = floats[at + 3];
      for (let k = 0; k < 4; k++) rotation[k] = floats[at + 4 + k];
      for (let k = 0; k < 3; k++) scale[k] = floats[at + 8 + k];
      for (let k = 0; k < 3; k++) colorDc[k] = floats[at + 12 + k];
      return;
    }
    const { min, step } = rangeOf(index);
    colorDc[0] = fromHalfBits(words[at + 3] & 0xffff);
    colorDc[1] = fromHalfBits(words[at + 3] >>> 16);
    colorDc[2] = fromHalfBits(words[at + 4] & 0xffff);
    splat.opacity = (words[at + 4] >>> 16) / 65535;
    scale[0] = exp(min + step * (words[at + 5] & 0xffff));
    scale[1] = exp(min + step * (words[at + 5] >>> 16));
    scale[2] = exp(min + step * (words[at + 6] & 0xffff));
    unpackRotation(words[at + 6] >>> 16, words[at + 7], rotation);
  };
}

/** Writes the unit quaternion of two half-words and a word as `packRotation` makes them. */
function unpackRotation(low: number, high: number, rotation: Float64Array): void {
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
