import { SH_REST_COEFFICIENTS, type ShDegree } from '../scene/splat-set.ts';
import { COEFFICIENT_MAX, fromHalfBits, HALF_MAX, toHalfBits } from './half.ts';

/** How the coefficients above degree 0 are stored; `u8` is a signed byte times a scale of the splat's own. */
export type ShPrecision = 'f32' | 'f16' | 'u8';

/**
 * Coefficients above degree 0 of N splats, as the GPU reads them: `wordsPerSplat` 32-bit words per splat, holding 3K
 * values in ascending (degree, order), each as r, g, b. f32: a word each. f16: two to a word, low half first.
 * u8: the first half-word is the splat's scale in binary16, then a signed byte each, value = scale · byte / 127.
 */
export interface ShRest {
  readonly degree: ShDegree;
  readonly precision: ShPrecision;
  readonly wordsPerSplat: number;
  /** N · wordsPerSplat words. */
  readonly words: Uint32Array;
}

/** Number of values, 3K, above degree 0. */
export function shRestValues(degree: ShDegree): number {
  return 3 * SH_REST_COEFFICIENTS[degree];
}

export function shRestWordsPerSplat(degree: ShDegree, precision: ShPrecision): number {
  const values = shRestValues(degree);
  if (values === 0) return 0;
  if (precision === 'f32') return values;
  if (precision === 'f16') return Math.ceil(values / 2);
  return Math.ceil((2 + values) / 4);
}

const f32 = new Float32Array(1);
const f32Bits = new Uint32Array(f32.buffer);

/** Packs one splat's 3K finite `values` into `words` from `wordOffset` on. Out-of-range values are clamped. */
export function packShRest(
  degree: ShDegree,
  precision: ShPrecision,
  values: ArrayLike<number>,
  words: Uint32Array,
  wordOffset: number,
): void {
  const count = shRestValues(degree);
  if (precision === 'f32') {
    for (let i = 0; i < count; i++) {
      f32[0] = Math.max(-COEFFICIENT_MAX, Math.min(COEFFICIENT_MAX, values[i]));
      words[wordOffset + i] = f32Bits[0];
    }
    return;
  }
  words.fill(0, wordOffset, wordOffset + shRestWordsPerSplat(degree, precision));
  if (precision === 'f16') {
    for (let i = 0; i < count; i++) words[wordOffset + (i >> 1)] |= toHalfBits(values[i]) << (16 * (i & 1));
    return;
  }
  let largest = 0;
  for (let i = 0; i < count; i++) largest = Math.max(largest, Math.abs(values[i]));
  let scaleBits = toHalfBits(largest);
  // Rounded up, so that the largest value still fits in ±127.
  if (fromHalfBits(scaleBits) < Math.min(largest, HALF_MAX)) scaleBits++;
  const scale = fromHalfBits(scaleBits);
  if (count > 0) words[wordOffset] = scaleBits;
  if (scale === 0) return;
  for (let i = 0; i < count; i++) {
    // Not Math.round and Math.min: reading a scene spends most of its time here, and this takes two thirds of theirs.
    let byte = Math.floor((values[i] / scale) * 127 + 0.5);
    if (byte < -127) byte = -127;
    else if (byte > 127) byte = 127;
    const place = i + 2;
    words[wordOffset + (place >> 2)] |= (byte & 0xff) << (8 * (place & 3));
  }
}

/** Writes splat `index`'s 3K values into `values`. */
export function unpackShRest(rest: ShRest, index: number, values: Float64Array | Float32Array): void {
  const count = shRestValues(rest.degree);
  const offset = index * rest.wordsPerSplat;
  const { words, precision } = rest;
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

/** The same coefficients in another precision; the very same object where it is the one they have. */
export function repackShRest(rest: ShRest, count: number, precision: ShPrecision): ShRest {
  if (rest.precision === precision) return rest;
  const wordsPerSplat = shRestWordsPerSplat(rest.degree, precision);
  const words = new Uint32Array(count * wordsPerSplat);
  const values = new Float64Array(shRestValues(rest.degree));
  for (let i = 0; i < count; i++) {
    unpackShRest(rest, i, values);
    packShRest(rest.degree, precision, values, words, i * wordsPerSplat);
  }
  return { degree: rest.degree, precision, wordsPerSplat, words };
}
