import type { FeatureOfCloud } from '../automatic-feature.ts';

/** Rotations do not change spheres. */
export const isotropic: FeatureOfCloud = {
  of: 'cloud',
  name: 'isotropic',
  label: 'Round splats',
  about: 'Ignores rotations if all splats are spheres.',
  stages: ['cull-splats', 'project'],
  calledFor: ({ shape }) => (shape.isIsotropic ? 'all splats are spheres' : null),
  offReason: ({ shape }) =>
    shape.cloud.facts.isIsotropic
      ? 'splats are round, but an effect may change their shapes'
      : 'some splats are not round',
};
