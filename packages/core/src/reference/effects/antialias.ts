import type { EffectTwin } from './effect-twin.ts';

export function antialiasTwin(): EffectTwin {
  return {
    changeOpacity: (opacity, { covariance, undilated }) =>
      opacity * Math.sqrt(undilated.determinant / covariance.determinant),
  };
}
