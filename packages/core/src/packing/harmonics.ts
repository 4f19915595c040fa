import { COEFFICIENT_MAX, fromHalfBits, HALF_MAX, toHalfBits } from '../layout/half.ts';
import { SH_REST_COEFFICIENTS, type ShDegree } from '../splats/splat-set.ts';
import type { ShPrecision } from './precision.ts';

/**
 * Coefficients above degree 0 of N splats, as the GPU reads them: `wordsPerSplat` 32-bit words per splat, holding 3K
 * values in ascending (degree, order), each as r, g, b. f32: a word each. f16: two to a word, low half first.
 * u8: the first half-word is the splat's scale in binary16, then a signed byte each, value = scale · byte / 127.
 */
export interface PackedHarmonics {
  readonly degree: ShDegree;
  readonly precision: ShPrecision;
  readonly wordsPerSplat: number;
  /** N · wordsPerSplat words. */
  readonly words: Uint32Array;
  /**
   * What `shBandReach` says of the coefficients as they were before they were rounded to this precision: the same
   * whichever that is. Absent where nobody knows, then it is taken from the words; whoever changes words leaves it out.
   */
  readonly bandReach?: readonly number[];
}

/** Number of values, 3K, above degree 0. */
export function coefficientsPerSplat(degree: ShDegree): number {
  return 3 * SH_REST_COEFFICIENTS[degree];
}

export function shWordsPerSplat(degree: ShDegree, precision: ShPrecision): number {
  return Math.ceil(shRestBytes(degree, precision) / 4);
}

/** Bytes that one splat's values take; the words that they lie in may have more. */
function shRestBytes(degree: ShDegree, precision: ShPrecision): number {
  const values = coefficientsPerSplat(degree);
  if (values === 0) return 0;
  if (precision === 'f32') return 4 * values;
  return precision === 'f16' ? 2 * values : 2 + values;
}

const f32 = new Float32Array(1);
const f32Bits = new Uint32Array(f32.buffer);

/** Packs one splat's 3K finite `values` into `words` from `wordOffset` on. Out-of-range values are clamped. */
export function packCoefficients(
  degree: ShDegree,
  precision: ShPrecision,
  values: ArrayLike<number>,
  words: Uint32Array,
  wordOffset: number,
): void {
  const count = coefficientsPerSplat(degree);
  if (precision === 'f32') {
    for (let i = 0; i < count; i++) {
      f32[0] = Math.max(-COEFFICIENT_MAX, Math.min(COEFFICIENT_MAX, values[i]));
      words[wordOffset + i] = f32Bits[0];
    }
    return;
  }
  words.fill(0, wordOffset, wordOffset + shWordsPerSplat(degree, precision));
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
export function readCoefficients(
  rest: PackedHarmonics,
  index: number,
  values: Float64Array | Float32Array,
): void {
  const count = coefficientsPerSplat(rest.degree);
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
export function repackHarmonics(
  rest: PackedHarmonics,
  count: number,
  precision: ShPrecision,
): PackedHarmonics {
  if (rest.precision === precision) return rest;
  const bandReach = shBandReach(rest, count);
  const wordsPerSplat = shWordsPerSplat(rest.degree, precision);
  const words = new Uint32Array(count * wordsPerSplat);
  const values = new Float64Array(coefficientsPerSplat(rest.degree));
  for (let i = 0; i < count; i++) {
    readCoefficients(rest, i, values);
    packCoefficients(rest.degree, precision, values, words, i * wordsPerSplat);
  }
  return { degree: rest.degree, precision, wordsPerSplat, words, bandReach };
}

/**
 * The coefficients of bands 1 to `degree` alone, as they are stored; the very same object where there are no others. Bytes
 * keep the scale that they were stored with.
 */
export function truncateHarmonics(rest: PackedHarmonics, count: number, degree: ShDegree): PackedHarmonics {
  if (degree >= rest.degree) return rest;
  const { precision, bandReach } = rest;
  const wordsPerSplat = shWordsPerSplat(degree, precision);
  const words = new Uint32Array(count * wordsPerSplat);
  const spareBytes = 4 * wordsPerSplat - shRestBytes(degree, precision);
  const lastWordMask = 0xffffffff >>> (8 * spareBytes);
  for (let i = 0; i < count && wordsPerSplat > 0; i++) {
    const from = i * rest.wordsPerSplat;
    const to = i * wordsPerSplat;
    for (let k = 0; k < wordsPerSplat; k++) words[to + k] = rest.words[from + k];
    words[to + wordsPerSplat - 1] &= lastWordMask;
  }
  return { degree, precision, wordsPerSplat, words, bandReach: bandReach?.slice(0, degree) };
}

/**
 * Per band 1…degree the most by which it can change any colour channel of any of the splats, whatever the direction: at
 * least 0, in units of the colours (0…1 from black to white).
 *
 * Band l adds Σ cₘYₗₘ(d) to a channel. By Cauchy and Schwarz that is at most ‖c‖·√(Σ Yₗₘ(d)²), and by the addition theorem
 * the sum is (2l + 1)/4π in every direction d. So √((2l + 1)/4π)·‖c‖ is never exceeded, and it is reached where c is a
 * multiple of Yₗ at some direction; no function of the band stays below 1/√(2l + 1) of it, its root mean square.
 */
export function shBandReach(rest: PackedHarmonics, count: number): readonly number[] {
  if (rest.bandReach) return rest.bandReach;
  const { degree, precision, wordsPerSplat, words } = rest;
  const meter = new ShReachMeter(degree);
  if (precision === 'f32') {
    const values = new Float32Array(words.buffer, words.byteOffset, words.length);
    for (let i = 0; i < count; i++) meter.include(values, i * wordsPerSplat);
  } else {
    const values = new Float64Array(coefficientsPerSplat(degree));
    for (let i = 0; i < count; i++) {
      readCoefficients(rest, i, values);
      meter.include(values, 0);
    }
  }
  return meter.reaches();
}

/** Measures what `shBandReach` answers, of splats that come one by one. */
export class ShReachMeter {
  /** Largest sum of squares of one channel's coefficients so far, by band. */
  readonly #squares: number[];

  constructor(degree: ShDegree) {
    this.#squares = Array.from({ length: degree }, () => 0);
  }

  /** One splat's 3K values, from `start` on; as they are stored in float32, whatever the array holds. */
  include(values: Float32Array | Float64Array, start: number): void {
    let at = start;
    for (let i = 0; i < this.#squares.length; i++) {
      const coefficients = 2 * i + 3;
      let red = 0;
      let green = 0;
      let blue = 0;
      for (const end = at + 3 * coefficients; at < end; at += 3) {
        const r = Math.fround(values[at]);
        const g = Math.fround(values[at + 1]);
        const b = Math.fround(values[at + 2]);
        red += r * r;
        green += g * g;
        blue += b * b;
      }
      const largest = Math.max(red, green, blue);
      if (largest > this.#squares[i]) this.#squares[i] = largest;
    }
  }

  /** Of all splats that were included. */
  reaches(): number[] {
    return this.#squares.map((squares, i) => Math.sqrt(((2 * i + 3) / (4 * Math.PI)) * squares));
  }
}
