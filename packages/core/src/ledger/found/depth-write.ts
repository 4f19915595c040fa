import type { FoundInView } from '../found-effect.ts';

/** Splats in front of meshes that are drawn later. */
export const depthWrite: FoundInView = {
  of: 'view',
  name: 'depth-write',
  label: 'Depth of splats',
  about: 'Blends the depth of the splats beside their colours, for what is drawn after them.',
  conditions: ['DEPTH_LAYER'],
  bindings: ['depthLayer'],
  stages: ['rasterize', 'upscale', 'compose'],
  calledFor: ({
    plan: {
      shape: { depth },
    },
  }) => (depth?.layerFormat ? `what is drawn later asks for it, blended in ${depth.layerFormat}` : null),
  offReason: () => 'nothing that is drawn later asks for it',
  bytes: ({ held }) => held.writtenDepthBytes,
};
