import type { FeatureOfView } from '../automatic-feature.ts';

/** Projection without a division by depth. */
export const orthographic: FeatureOfView = {
  of: 'view',
  name: 'orthographic',
  label: 'Orthographic view',
  about: 'Projects splats without perspective: all share one Jacobian.',
  stages: ['cull-splats', 'project', 'rasterize', 'tile-rasterize', 'compose'],
  calledFor: ({ plan }) => (plan.shape.isOrthographic ? 'the camera has no perspective' : null),
  offReason: () => 'the camera has perspective',
};
