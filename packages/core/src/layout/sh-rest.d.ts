import { type ShDegree } from '../scene/splat-set.ts';
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
export declare function shRestValues(degree: ShDegree): number;
export declare function shRestWordsPerSplat(degree: ShDegree, precision: ShPrecision): number;
/** Packs one splat's 3K finite `values` into `words` from `wordOffset` on. Out-of-range values are clamped. */
export declare function packShRest(
  degree: ShDegree,
  precision: ShPrecision,
  values: ArrayLike<number>,
  words: Uint32Array,
  wordOffset: number,
): void;
/** Writes splat `index`'s 3K values into `values`. */
export declare function unpackShRest(rest: ShRest, index: number, values: Float64Array | Float32Array): void;
/** The same coefficients in another precision; the very same object where it is the one they have. */
export declare function repackShRest(rest: ShRest, count: number, precision: ShPrecision): ShRest;
