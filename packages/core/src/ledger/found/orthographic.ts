import type { FoundInView } from '../found-effect.ts';

/** Without perspective there is nothing to divide by. */
export const orthographic: FoundInView = {
  of: 'view',
  name: 'orthographic',
  label: 'Orthographic view',
  about: 'Projects splats without perspective: one Jacobian does for all.',
  conditions: ['ORTHOGRAPHIC'],
  bindings: [],
  stages: ['cull-splats', 'project', 'rasterize', 'compose'],
  calledFor: ({ plan }) => (plan.shape.isOrthographic ? 'the camera has no perspective' : null),
  offReason: () => 'the camera has perspective',
};
