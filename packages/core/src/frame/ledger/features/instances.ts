import type { FeatureOfCloud } from '../automatic-feature.ts';

/** Stages choose the page of one instance among those of a batch. */
export const instances: FeatureOfCloud = {
  of: 'cloud',
  name: 'instances',
  label: 'Instances',
  about: 'Draws a cloud in many places, all of them together.',
  stages: ['cut-count', 'cull-chunks', 'cut-splats', 'cull-splats', 'project', 'wide-keys'],
  calledFor: ({ shape: { instanceCount } }) =>
    instanceCount === null ? null : `it is asked for in ${instanceCount.toLocaleString('en')} places`,
  offReason: () => 'it is asked for in one place',
};
