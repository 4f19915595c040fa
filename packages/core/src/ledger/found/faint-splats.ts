import { hasHook } from '../../effects/effect-set.ts';
import type { DrawnCloud, FoundInCloud } from '../found-effect.ts';

/** Most clouds that were trained have splats that nobody can see. */
export const faintSplats: FoundInCloud = {
  of: 'cloud',
  name: 'faint-splats',
  label: 'Faint splats',
  about: 'Tests each splat’s opacity against the cutoff before anything else is done with it.',
  conditions: ['FAINT_SPLATS'],
  bindings: [],
  stages: ['cull-splats'],
  calledFor: (cloud) => {
    const { shape, index } = cloud;
    if (!shape.hasFaintSplats[index]) return null;
    return hasHook(shape.effects[index], 'splat') ? 'effects may make splats fainter' : comparison(cloud);
  },
  offReason: comparison,
};

function comparison({ instance, shape }: DrawnCloud): string {
  const { minOpacity } = instance.cloud.facts;
  const { alphaCutoff } = shape.accuracy;
  return `the least opacity is ${shortened(minOpacity)} and the cutoff ${shortened(alphaCutoff)}`;
}

function shortened(value: number): number {
  return Number(value.toPrecision(2));
}
