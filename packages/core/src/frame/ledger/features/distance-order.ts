import type { FeatureOfCloud } from '../automatic-feature.ts';

/** The order of distances. A frame has one order; it is on for clouds that ask for this one. */
export const distanceOrder: FeatureOfCloud = {
  of: 'cloud',
  name: 'distance-order',
  label: 'Order of distances',
  about: 'Sorts splats by their distances from the camera, not by their depths.',
  stages: ['cull-splats', 'project', 'wide-keys'],
  calledFor: ({ plan, shape: { cloud } }) => {
    if (!plan.shape.sortsByDistance) return null;
    if (plan.request.sortBy === 'distance') return 'the request asks for it';
    return cloud.facts.fileFacts?.isSortedByDistance ? 'its file asks for it' : null;
  },
  offReason: ({ plan }) => {
    if (plan.shape.isOrthographic) return 'the camera has no perspective';
    return plan.request.sortBy === 'depth' ? 'the request asks for depths' : 'no file asks for it';
  },
};
