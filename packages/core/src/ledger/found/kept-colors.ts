import { hasHook } from '../../effects/effect-set.ts';
import { canKeepColors } from '../../frame/parts/kept-colors.ts';
import type { FoundInCloud } from '../found-effect.ts';

/** Evaluates the harmonics once per splat and camera position. */
export const keptColors: FoundInCloud = {
  of: 'cloud',
  name: 'kept-colors',
  label: 'Kept colours',
  about: 'Keeps the colours of splats while they are seen from one place.',
  stages: ['keep-colors', 'project'],
  calledFor: ({ shape }) => {
    if (!shape.keepsColors) return null;
    return hasHook(shape.effects, 'color')
      ? 'effects change its colours, which are evaluated once per camera position'
      : 'the camera has turned and not moved';
  },
  offReason: ({ plan, index, shape }) => {
    if (shape.shDegree === 0) return 'its colours are the same from everywhere';
    return canKeepColors(plan, index)
      ? 'it was not seen twice from the same place'
      : 'its effects change more than kept colours can follow';
  },
  bytes: ({ held }) => held.keptColorsBytes,
};
