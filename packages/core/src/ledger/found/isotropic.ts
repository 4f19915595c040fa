import type { FoundInCloud } from '../found-effect.ts';

/** Balls are the same however they are turned. */
export const isotropic: FoundInCloud = {
  of: 'cloud',
  name: 'isotropic',
  label: 'Round splats',
  about: 'Leaves rotations out where all splats are balls.',
  conditions: ['ISOTROPIC'],
  bindings: [],
  stages: ['cull-splats', 'project'],
  calledFor: ({ shape }) => (shape.isIsotropic ? 'each splat is as long, as wide and as high' : null),
  offReason: ({ shape }) =>
    shape.cloud.facts.isIsotropic
      ? 'splats are round, but an effect may change their shapes'
      : 'splats are longer one way than another',
};
