import type { EffectReference } from '../../../reference/effects/effect-reference.ts';

export const example = true;

export function reference(): EffectReference {
  return {
    changeOpacity: (opacity, { covariance, undilated }) =>
      opacity * Math.sqrt(undilated.determinant / covariance.determinant),
  };
}
