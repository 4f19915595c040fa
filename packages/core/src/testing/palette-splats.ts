import type { HarmonicsPalette } from '../data/packing/harmonics-palette.ts';
import { coefficientsPerSplat, type SplatSet } from '../data/splats/splat-set.ts';
import { type RandomSplatOptions, randomSplats } from './random-splats.ts';
import { seededRandom } from './seeded-random.ts';

/** Random splats with a palette of random entries, of which the first splat has the last. */
export function paletteSplats(
  options: RandomSplatOptions & { readonly entryCount: number },
): SplatSet<HarmonicsPalette> {
  const { count, entryCount, seed = 1, shDegree = 3 } = options;
  const random = seededRandom(seed + 1000);
  const entries = Float32Array.from(
    { length: entryCount * coefficientsPerSplat(shDegree) },
    () => 0.6 * random() - 0.3,
  );
  const indices = Uint16Array.from({ length: count }, () => Math.floor(entryCount * random()));
  indices.fill(entryCount - 1, 0, 1);
  return { ...randomSplats(options), harmonics: { degree: shDegree, entries, indices } };
}

/** The same splats with coefficients of their own. */
export function withOwnCoefficients({ harmonics, ...set }: SplatSet<HarmonicsPalette>): SplatSet {
  const { degree, entries, indices } = harmonics;
  const length = coefficientsPerSplat(degree);
  const coefficients = new Float32Array(set.count * length);
  for (let i = 0; i < set.count; i++)
    coefficients.set(entries.subarray(indices[i] * length, (indices[i] + 1) * length), i * length);
  return { ...set, harmonics: { degree, coefficients } };
}
