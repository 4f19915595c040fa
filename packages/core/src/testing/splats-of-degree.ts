import { coefficientsPerSplat, type ShDegree, type SplatSet } from '../splats/splat-set.ts';

/** The splats of `set` as a file of `degree`, which is at most theirs, has them. */
export function splatsOfDegree(set: SplatSet, degree: ShDegree): SplatSet {
  const from = coefficientsPerSplat(set.harmonics.degree);
  const to = coefficientsPerSplat(degree);
  const coefficients = new Float32Array(set.count * to);
  for (let i = 0; i < set.count; i++)
    coefficients.set(set.harmonics.coefficients.subarray(from * i, from * i + to), to * i);
  return { ...set, harmonics: { degree, coefficients } };
}
