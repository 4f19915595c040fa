import { checkKind } from '../given.ts';
import type { Harmonics } from '../packing/harmonics.ts';
import { givenSet } from '../splats/check-set.ts';
import type { ShDegree, SplatSet } from '../splats/splat-set.ts';
import { trainedCoefficients } from './trained-coefficients.ts';

/** The set without harmonics above `degree`; itself if it has none. */
export function limitDegree(set: SplatSet<Harmonics>, degree: ShDegree): SplatSet<Harmonics> {
  checkKind('degree', degree, 'a number');
  if (givenSet(set).harmonics.degree <= degree) return set;
  return { ...set, harmonics: { degree, coefficients: trainedCoefficients(set, degree) } };
}
