import { hasHook } from '../../effects/effect-set.ts';
import type { DrawnCloud, FoundInCloud } from '../found-effect.ts';

/** Splats too faint to see, which most trained clouds have. */
export const faintSplats: FoundInCloud = {
  of: 'cloud',
  name: 'faint-splats',
  label: 'Faint splats',
  about: 'Tests each splat’s opacity against the cutoff before anything else.',
  stages: ['cull-splats'],
  calledFor: (cloud) => {
    const { shape } = cloud;
    if (!shape.hasFaintSplats) return null;
    return hasHook(shape.effects, 'splat') ? 'effects may make splats fainter' : comparison(cloud);
  },
  offReason: comparison,
};

function comparison({ plan, shape }: DrawnCloud): string {
  const { minOpacity } = shape.cloud.facts;
  const { alphaCutoff } = plan.shape.accuracy;
  return `the lowest opacity is ${shortened(minOpacity)} and the cutoff ${shortened(alphaCutoff)}`;
}

function shortened(value: number): number {
  return Number(value.toPrecision(2));
}
