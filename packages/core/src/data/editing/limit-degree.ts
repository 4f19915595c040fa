import { checkKind } from '../given.ts';
import { type Harmonics, readCoefficients } from '../packing/harmonics.ts';
import { givenSet } from '../splats/check-set.ts';
import { coefficientsPerSplat, type ShDegree, type SplatSet } from '../splats/splat-set.ts';

/**
 * The set without harmonics above `degree`; itself if it has none.
 *
 * @example
 * const set = await readSplats('/garden.ply', { shPrecision: 'f32' });
 * const smaller = await writeSplats(limitDegree(set, 1), 'spz');
 */
export function limitDegree(set: SplatSet<Harmonics>, degree: ShDegree): SplatSet<Harmonics> {
  checkKind('degree', degree, 'a number');
  if (givenSet(set).harmonics.degree <= degree) return set;
  return { ...set, harmonics: { degree, coefficients: trainedCoefficients(set, degree) } };
}

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
