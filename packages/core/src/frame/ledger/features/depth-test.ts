import type { FeatureOfView } from '../automatic-feature.ts';

/** Meshes that hide splats. */
export const depthTest: FeatureOfView = {
  of: 'view',
  name: 'depth-test',
  label: 'Hidden by meshes',
  about: 'Tests splats against the depth of meshes drawn before.',
  stages: ['resolve-depth', 'rasterize', 'tile-rasterize', 'compose'],
  calledFor: ({
    plan: {
      shape: { depth },
    },
  }) =>
    depth &&
    `something may hide splats, and its depth is ${depth.mapping === 'logarithmic' ? 'logarithmic' : 'that of the projection'}`,
  offReason: () => 'nothing was drawn that could hide splats',
  bytes: ({ held }) => held.testedDepthBytes,
};
