import { type PackedHarmonics, packCoefficients, readCoefficients } from '../data/packing/harmonics.ts';
import { coefficientsPerSplat } from '../data/splats/splat-set.ts';

/** Reference of morph-sh, in float64: the harmonics of two pages, blended, and packed as they are. */
export function morphSh(
  first: PackedHarmonics,
  second: PackedHarmonics,
  count: number,
  amount: number,
): PackedHarmonics {
  const { degree, precision, wordsPerSplat } = first;
  const words = new Uint32Array(count * wordsPerSplat);
  const width = coefficientsPerSplat(degree);
  const [a, b] = [new Float64Array(width), new Float64Array(width)];
  for (let i = 0; i < count; i++) {
    readCoefficients(first, i, a);
    readCoefficients(second, i, b);
    const blended = a.map((value, k) => value * (1 - amount) + b[k] * amount);
    packCoefficients(degree, precision, blended, words, i * wordsPerSplat);
  }
  return { degree, precision, wordsPerSplat, words };
}
