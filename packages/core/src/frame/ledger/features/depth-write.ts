import type { FeatureOfView } from '../automatic-feature.ts';

/** Splats that hide meshes drawn later. */
export const depthWrite: FeatureOfView = {
  of: 'view',
  name: 'depth-write',
  label: 'Depth of splats',
  about: 'Writes the depth of splats along with their colours, for what the host draws later.',
  stages: ['rasterize', 'tile-rasterize', 'upscale', 'compose'],
  calledFor: ({
    plan: {
      shape: { depth },
    },
  }) => (depth?.layerFormat ? `the host needs it, in ${depth.layerFormat}` : null),
  offReason: () => 'no host needs it',
  bytes: ({ held }) => held.writtenDepthBytes,
};
