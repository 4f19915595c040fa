import type { StageDefinition } from '../pipelines.ts';

/** Lists the visible splats of the frame in storage order. */
export const compactSplats = {
  stage: 'compact-splats',
  entryPoint: 'compactSplats',
  bindings: {
    cullParameters: [0, 'uniform'],
    chunkOffsets: [1, 'read'],
    visibleChunks: [2, 'read'],
    visibilityMasks: [3, 'read'],
    splatOffsets: [4, 'read'],
    visibleSplats: [5, 'read-write'],
  },
} as const satisfies StageDefinition;
