import { CHUNK_SPLATS } from '../layout/constants.ts';
import { GEOMETRY_WORDS } from '../packing/geometry.ts';
import type { LogScaleRange } from '../packing/log-scale.ts';
import { BLOB_PRECISION } from '../packing/precision.ts';
import { splatReader } from '../packing/unpack-geometry.ts';
import type { MergedLeaf } from './cell-merger.ts';

/** Words of a splat, a leaf of the lowest level, and of a blob, one of the others. */
export const SPLAT_WORDS = GEOMETRY_WORDS.packed;
export const BLOB_WORDS = GEOMETRY_WORDS[BLOB_PRECISION.geometryPrecision];
/** Where the sums of a blob are among its words: opacity times rim length, and opacity. */
const RIM_WORD = 11;
const OPACITY_WORD = 15;
/** Scales of blobs are float32. */
const NO_RANGE: LogScaleRange = { min: 0, step: 0 };

/** Reads leaf `leaf` into `result`. */
export type LeafReader = (leaf: number, result: MergedLeaf) => void;

/** Reads packed splats. @param ranges of the log scales of each chunk. */
export function leafReader(words: Uint32Array, ranges: readonly LogScaleRange[]): LeafReader {
  return splatReader({ precision: 'packed', words }, (splat) => ranges[Math.floor(splat / CHUNK_SPLATS)]);
}

export function blobReader(words: Uint32Array): LeafReader {
  const floats = new Float32Array(words.buffer, words.byteOffset, words.length);
  const read = splatReader({ precision: BLOB_PRECISION.geometryPrecision, words }, () => NO_RANGE);
  return (blob, result) => {
    read(blob, result);
    result.sums[0] = floats[blob * BLOB_WORDS + RIM_WORD];
    result.sums[1] = floats[blob * BLOB_WORDS + OPACITY_WORD];
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
