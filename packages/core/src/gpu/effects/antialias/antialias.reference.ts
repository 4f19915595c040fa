import type { EffectReference } from '../../../reference/effects/effect-reference.ts';
import { thinnedOpacity } from '../../../reference/stacked-opacity.ts';

export const example = true;

export function reference(): EffectReference {
  return {
    changeOpacity: (opacity, { covariance, undilated }) =>
      thinnedOpacity(opacity, Math.sqrt(undilated.determinant / covariance.determinant)),
  };
}
