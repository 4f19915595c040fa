import { type Harmonics, readCoefficients } from '../packing/harmonics.ts';
import { coefficientsPerSplat, type ShDegree, type SplatSet } from '../splats/splat-set.ts';

/** Harmonics of a set as trained, N · 3K, K of `degree`: no higher bands, missing ones 0. */
export function trainedCoefficients(
  { count, harmonics }: SplatSet<Harmonics>,
  degree: ShDegree = harmonics.degree,
): Float32Array {
  const width = coefficientsPerSplat(degree);
  const row = new Float32Array(coefficientsPerSplat(harmonics.degree));
  const kept = row.subarray(0, width);
  const coefficients = new Float32Array(count * width);
  for (let i = 0; i < count; i++) {
    readCoefficients(harmonics, i, row);
    coefficients.set(kept, i * width);
  }
  return coefficients;
}
