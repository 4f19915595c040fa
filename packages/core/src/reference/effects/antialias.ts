import type { EffectReference } from './effect-reference.ts';

export function antialiasReference(): EffectReference {
  return {
    changeOpacity: (opacity, { covariance, undilated }) =>
      opacity * Math.sqrt(undilated.determinant / covariance.determinant),
  };
}
