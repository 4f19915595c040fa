import type { FoundInView } from '../found-effect.ts';

/** Splats that hide meshes drawn later. */
export const depthWrite: FoundInView = {
  of: 'view',
  name: 'depth-write',
  label: 'Depth of splats',
  about: 'Blends the depth of splats along with their colours, for meshes drawn later.',
  stages: ['rasterize', 'tile-rasterize', 'upscale', 'compose'],
  calledFor: ({
    plan: {
      shape: { depth },
    },
  }) => (depth?.layerFormat ? `the host needs it, blended in ${depth.layerFormat}` : null),
  offReason: () => 'no host needs it',
  bytes: ({ held }) => held.writtenDepthBytes,
};
