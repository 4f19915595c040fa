import { COEFFICIENT_MAX, clampCoefficient } from '../layout/half.ts';
import { coefficientsPerSplat, type ShDegree, type TrainedHarmonics } from '../splats/splat-set.ts';
import { shBandReach } from './band-reach.ts';
import {
  type PackedHarmonics,
  type PackedPalette,
  packCoefficients,
  readCoefficients,
  shBytesPerSplat,
  shWordsPerSplat,
} from './harmonics.ts';
import type { HarmonicsPalette } from './harmonics-palette.ts';
import type { OwnShPrecision } from './precision.ts';

/**
 * `harmonics` as f32 words, clamped to ± COEFFICIENT_MAX. They are the memory of the coefficients
 * themselves unless one has to be clamped: harmonics are most of a scene's bytes, and a copy would
 * double them while a set is packed.
 */
export function packHarmonics({ degree, coefficients }: TrainedHarmonics): PackedHarmonics {
  const wordsPerSplat = shWordsPerSplat(degree, 'f32');
  const isInRange = coefficients.every((value) => Math.abs(value) <= COEFFICIENT_MAX);
  const { buffer, byteOffset, length } = isInRange ? coefficients : coefficients.map(clampCoefficient);
  return { degree, precision: 'f32', wordsPerSplat, words: new Uint32Array(buffer, byteOffset, length) };
}

/** The same coefficients in `precision`; the very same object if they have it already. */
export function repackHarmonics(
  harmonics: PackedHarmonics,
  count: number,
  precision: OwnShPrecision,
): PackedHarmonics {
  if (harmonics.precision === precision) return harmonics;
  const bandReach = shBandReach(harmonics, count);
  const wordsPerSplat = shWordsPerSplat(harmonics.degree, precision);
  const words = new Uint32Array(count * wordsPerSplat);
  const values = new Float64Array(coefficientsPerSplat(harmonics.degree));
  for (let i = 0; i < count; i++) {
    readCoefficients(harmonics, i, values);
    packCoefficients(harmonics.degree, precision, values, words, i * wordsPerSplat);
  }
  return { degree: harmonics.degree, precision, wordsPerSplat, words, bandReach };
}

/**
 * Bands 1 to `degree` alone, as they are stored; the very same object if there are no others. Bytes
 * keep the scale that they were stored with.
 */
export function truncateHarmonics(
  harmonics: PackedHarmonics,
  count: number,
  degree: ShDegree,
): PackedHarmonics {
  if (degree >= harmonics.degree) return harmonics;
  const { precision, bandReach } = harmonics;
  const wordsPerSplat = shWordsPerSplat(degree, precision);
  const words = new Uint32Array(count * wordsPerSplat);
  const spareBytes = 4 * wordsPerSplat - shBytesPerSplat(degree, precision);
  const lastWordMask = 0xffffffff >>> (8 * spareBytes);
  for (let i = 0; i < count && wordsPerSplat > 0; i++) {
    const from = i * harmonics.wordsPerSplat;
    const to = i * wordsPerSplat;
    for (let k = 0; k < wordsPerSplat; k++) words[to + k] = harmonics.words[from + k];
    words[to + wordsPerSplat - 1] &= lastWordMask;
  }
  return { degree, precision, wordsPerSplat, words, bandReach: bandReach?.slice(0, degree) };
}

/** Bands 1 to `degree` of a palette, clamped like all coefficients. */
export function packPalette(
  { degree: whole, entries, indices }: HarmonicsPalette,
  degree: ShDegree,
): PackedPalette {
  const [before, kept] = [whole, degree].map(coefficientsPerSplat);
  const values = entries.filter((_, i) => i % before < kept).map(clampCoefficient);
  return { degree, precision: 'palette', entries: values, indices };
}
