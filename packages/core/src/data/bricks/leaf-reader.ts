import { CHUNK_SPLATS } from '../layout/constants.ts';
import { fromHalfBits } from '../layout/half.ts';
import { GEOMETRY_WORDS, unpackRotation } from '../packing/geometry.ts';
import type { LogScaleRange } from '../packing/log-scale.ts';
import { BLOB_PRECISION } from '../packing/precision.ts';
import type { MergedLeaf } from './cell-merger.ts';

/** Words of a splat, a leaf of the lowest level, and of a blob, one of the others. */
export const SPLAT_WORDS = GEOMETRY_WORDS.packed;
export const BLOB_WORDS = GEOMETRY_WORDS[BLOB_PRECISION.geometryPrecision];
/** Where the sums of a blob are among its words: opacity times rim length, and opacity. */
const RIM_WORD = 11;
const OPACITY_WORD = 15;

/** Reads leaf `leaf` into `result`. */
export type LeafReader = (leaf: number, result: MergedLeaf) => void;

/** Reads packed splats as shaders unpack them. @param ranges of the log scales of each chunk. */
export function splatReader(words: Uint32Array, ranges: readonly LogScaleRange[]): LeafReader {
  const floats = new Float32Array(words.buffer, words.byteOffset, words.length);
  return (splat, result) => {
    const at = splat * SPLAT_WORDS;
    const { min, step } = ranges[Math.floor(splat / CHUNK_SPLATS)];
    const { position, rotation, scale, colorDc } = result;
    for (let axis = 0; axis < 3; axis++) position[axis] = floats[at + axis];
    result.opacity = (words[at + 4] >>> 16) / 65535;
    scale[0] = Math.exp(min + step * (words[at + 5] & 0xffff));
    scale[1] = Math.exp(min + step * (words[at + 5] >>> 16));
    scale[2] = Math.exp(min + step * (words[at + 6] & 0xffff));
    unpackRotation(words[at + 6] >>> 16, words[at + 7], rotation);
    colorDc[0] = fromHalfBits(words[at + 3] & 0xffff);
    colorDc[1] = fromHalfBits(words[at + 3] >>> 16);
    colorDc[2] = fromHalfBits(words[at + 4] & 0xffff);
  };
}

export function blobReader(words: Uint32Array): LeafReader {
  const floats = new Float32Array(words.buffer, words.byteOffset, words.length);
  return (blob, result) => {
    const at = blob * BLOB_WORDS;
    for (let axis = 0; axis < 3; axis++) {
      result.position[axis] = floats[at + axis];
      result.scale[axis] = floats[at + 8 + axis];
      result.colorDc[axis] = floats[at + 12 + axis];
    }
    result.opacity = floats[at + 3];
    for (let k = 0; k < 4; k++) result.rotation[k] = floats[at + 4 + k];
    result.sums[0] = floats[at + RIM_WORD];
    result.sums[1] = floats[at + OPACITY_WORD];
  };
}

/** Packs a blob as float32 geometry, with its sums in the words that splats leave empty. */
export function packBlob(
  { position, opacity, rotation, scale, colorDc, sums }: MergedLeaf<Float64Array | Float32Array>,
  words: Uint32Array<ArrayBuffer>,
  at: number,
): void {
  const floats = new Float32Array(words.buffer, 4 * at, BLOB_WORDS);
  floats.set(position, 0);
  floats[3] = opacity;
  floats.set(rotation, 4);
  floats.set(scale, 8);
  floats[RIM_WORD] = sums[0];
  floats.set(colorDc, 12);
  floats[OPACITY_WORD] = sums[1];
}
