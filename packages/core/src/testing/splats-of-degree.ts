import { coefficientsPerSplat, type ShDegree, type SplatSet } from '../data/splats/splat-set.ts';

/** The splats of `set` as they would be in a file of `degree`, which is at most their own. */
export function splatsOfDegree(set: SplatSet, degree: ShDegree): SplatSet {
  const from = coefficientsPerSplat(set.harmonics.degree);
  const to = coefficientsPerSplat(degree);
  const coefficients = new Float32Array(set.count * to);
  for (let i = 0; i < set.count; i++)
    coefficients.set(set.harmonics.coefficients.subarray(from * i, from * i + to), to * i);
  return { ...set, harmonics: { degree, coefficients } };
}
