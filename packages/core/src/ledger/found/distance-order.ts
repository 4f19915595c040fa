import type { FoundInCloud } from '../found-effect.ts';

/** The order of distances. All clouds of a frame have one order; it is on for those that ask for this one. */
export const distanceOrder: FoundInCloud = {
  of: 'cloud',
  name: 'distance-order',
  label: 'Order of distances',
  about: 'Sorts splats by their distances from the camera, not by their depths.',
  conditions: ['DISTANCE_ORDER'],
  bindings: [],
  stages: ['cull-splats', 'project'],
  calledFor: ({ plan: { shape, request }, cloud: { instance } }) => {
    if (!shape.sortsByDistance) return null;
    if (request.sortBy === 'distance') return 'the request asks for it';
    return instance.cloud.facts.fileFacts?.isSortedByDistance ? 'its file asks for it' : null;
  },
  offReason: ({ plan: { shape, request } }) => {
    if (shape.isOrthographic) return 'the camera has no perspective';
    return request.sortBy === 'depth' ? 'the request asks for depths' : 'no file asks for it';
  },
};
