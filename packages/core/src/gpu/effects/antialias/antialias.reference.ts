import type { EffectReference } from '../../../reference/effects/effect-reference.ts';

export const example = true;

const STACK_LOSS = 0.5;

export function reference(): EffectReference {
  return {
    changeOpacity: (opacity, { covariance, undilated }) => {
      const share = Math.sqrt(undilated.determinant / covariance.determinant);
      return opacity <= 1 ? share * opacity : share * opacity ** (1 - STACK_LOSS * (1 - share));
    },
  };
}
