import { clampCoefficient, fromHalfBits, HALF_MAX, toHalfBits } from '../layout/half.ts';
import { coefficientsPerSplat, type ShDegree, type TrainedHarmonics } from '../splats/splat-set.ts';
import type { HarmonicsPalette } from './harmonics-palette.ts';
import type { OwnShPrecision } from './precision.ts';

/**
 * Spherical harmonics above degree 0 of N splats, as the GPU reads them: `wordsPerSplat` 32-bit
 * words per splat, which hold its 3K coefficients in ascending (degree, order), each as r, g, b.
 * f32: a word each. f16: two to a word, low half first. u8: the first half-word is the splat's
 * scale in binary16, then a signed byte each, value = scale · byte / 127.
 */
export interface PackedHarmonics {
  readonly degree: ShDegree;
  readonly precision: OwnShPrecision;
  readonly wordsPerSplat: number;
  /** N · wordsPerSplat words. */
  readonly words: Uint32Array;
  /**
   * `shBandReach` of the coefficients before they were rounded, so the same in every precision.
   * Leave it out where that is not known, or where words were changed: it is then measured on the
   * words.
   */
  readonly bandReach?: readonly number[];
}

/** A palette whose entries have the values that the GPU reads. */
export interface PackedPalette extends HarmonicsPalette {
  readonly precision: 'palette';
}

/** Harmonics above degree 0 from a reader: packed, or the file's own palette, which is smaller. */
export type ReadHarmonics = PackedHarmonics | HarmonicsPalette;

/** Spherical harmonics above degree 0 as a cloud stores them. */
export type StoredHarmonics = PackedHarmonics | PackedPalette;

/** Spherical harmonics above degree 0, in any form. */
export type Harmonics = TrainedHarmonics | ReadHarmonics | StoredHarmonics;

export function isPacked(harmonics: Harmonics): harmonics is PackedHarmonics {
  return 'words' in harmonics;
}

export function isPalette(harmonics: Harmonics): harmonics is HarmonicsPalette {
  return 'indices' in harmonics;
}

/** Number of a palette's entries; 0 at degree 0, where they would be empty. */
export function entryCountOf({ degree, entries }: HarmonicsPalette): number {
  return entries.length / coefficientsPerSplat(degree) || 0;
}

/**
 * 32-bit words of one splat's coefficients.
 *
 * @hidden Shared with the packages beside this one.
 */
export function shWordsPerSplat(degree: ShDegree, precision: OwnShPrecision): number {
  return Math.ceil(shBytesPerSplat(degree, precision) / 4);
}

/** Bytes of one splat's coefficients; the words that hold them may have more. */
export function shBytesPerSplat(degree: ShDegree, precision: OwnShPrecision): number {
  const values = coefficientsPerSplat(degree);
  if (values === 0) return 0;
  if (precision === 'f32') return 4 * values;
  return precision === 'f16' ? 2 * values : 2 + values;
}

/**
 * How entries of palettes are stored: as trained, so that a palette stands for every precision.
 * 65,536 of them take 12 MB. Images of random coefficients of ±0.3 came within 136 dB of float64,
 * and within 92 dB with entries in float16.
 */
export const ENTRY_PRECISION = 'f32';

/**
 * Returns a function that makes the words of a page of splats as the GPU reads them: all entries,
 * then the entry of each splat from `start` to `end`, two to a word.
 */
export function paletteWordsOf({ entries, indices }: PackedPalette) {
  return (start: number, end: number): Uint32Array => {
    const words = new Uint32Array(entries.length + Math.ceil((end - start) / 2));
    new Float32Array(words.buffer).set(entries);
    new Uint16Array(words.buffer, entries.byteLength).set(indices.subarray(start, end));
    return words;
  };
}

const f32 = new Float32Array(1);
const f32Bits = new Uint32Array(f32.buffer);

/** Packs one splat's 3K finite `values` into `words` from `wordOffset` on, clamped to range. */
export function packCoefficients(
  degree: ShDegree,
  precision: OwnShPrecision,
  values: ArrayLike<number>,
  words: Uint32Array,
  wordOffset: number,
): void {
  const count = coefficientsPerSplat(degree);
  if (precision === 'f32') {
    for (let i = 0; i < count; i++) {
      f32[0] = clampCoefficient(values[i]);
      words[wordOffset + i] = f32Bits[0];
    }
    return;
  }
  if (precision === 'f16') {
    words.fill(0, wordOffset, wordOffset + shWordsPerSplat(degree, precision));
    for (let i = 0; i < count; i++) words[wordOffset + (i >> 1)] |= toHalfBits(values[i]) << (16 * (i & 1));
    return;
  }
  let largest = 0;
  for (let i = 0; i < count; i++) largest = Math.max(largest, Math.abs(values[i]));
  let scaleBits = toHalfBits(largest);
  // Rounded up, so that the largest value still fits in ±127.
  if (fromHalfBits(scaleBits) < Math.min(largest, HALF_MAX)) scaleBits++;
  const scale = fromHalfBits(scaleBits);
  // Reading a scene spends most of its time here: each word is written once.
  let word = scaleBits;
  let place = 2;
  let at = wordOffset;
  for (let i = 0; i < count; i++) {
    word |= (scale > 0 ? signedByte((values[i] / scale) * 127) & 0xff : 0) << (8 * place);
    place = (place + 1) & 3;
    if (place > 0) continue;
    words[at++] = word;
    word = 0;
  }
  if (place > 0 && count > 0) words[at] = word;
}

/** Rounded to -127…127, in two thirds of the time of Math.round and Math.min. */
function signedByte(value: number): number {
  const byte = Math.floor(value + 0.5);
  if (byte < -127) return -127;
  return byte > 127 ? 127 : byte;
}

/**
 * Writes splat `index`'s 3K coefficients into `values`.
 *
 * @example
 * const { harmonics } = await readSplats('/garden.ply');
 * const coefficients = new Float32Array(coefficientsPerSplat(harmonics.degree));
 * readCoefficients(harmonics, 0, coefficients);
 */
export function readCoefficients(
  harmonics: Harmonics,
  index: number,
  values: Float64Array | Float32Array,
): void {
  const count = coefficientsPerSplat(harmonics.degree);
  if (!isPacked(harmonics)) {
    const floats = isPalette(harmonics) ? harmonics.entries : harmonics.coefficients;
    const start = count * (isPalette(harmonics) ? harmonics.indices[index] : index);
    for (let i = 0; i < count; i++) values[i] = floats[start + i];
    return;
  }
  const { words, precision, wordsPerSplat } = harmonics;
  const offset = index * wordsPerSplat;
  const scale = precision === 'u8' && count > 0 ? fromHalfBits(words[offset] & 0xffff) / 127 : 0;
  for (let i = 0; i < count; i++) {
    if (precision === 'f32') {
      f32Bits[0] = words[offset + i];
      values[i] = f32[0];
    } else if (precision === 'f16') {
      values[i] = fromHalfBits((words[offset + (i >> 1)] >>> (16 * (i & 1))) & 0xffff);
    } else {
      const place = i + 2;
      values[i] = (((words[offset + (place >> 2)] >>> (8 * (place & 3))) << 24) >> 24) * scale;
    }
  }
}
