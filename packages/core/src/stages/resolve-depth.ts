import type { RenderState, StageDefinition } from '../gpu/pipelines.ts';
import { TESTED_DEPTH_FORMAT } from './rasterize.ts';

/** Copies the host's depth under the splats' picture. */
export function resolveDepth(isMultisampled: boolean) {
  return {
    stage: 'resolve-depth',
    conditions: { MULTISAMPLED: isMultisampled },
    bindings: {
      viewport: [0, 'uniform'],
      hostDepths: [1, isMultisampled ? 'multisampled-depth-texture' : 'depth-texture'],
    },
  } as const satisfies StageDefinition;
}

export const resolveDepthState: RenderState = {
  topology: 'triangle-list',
  targets: [],
  depth: { format: TESTED_DEPTH_FORMAT, depthCompare: 'always', depthWriteEnabled: true },
};
