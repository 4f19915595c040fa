import type { StageDefinition } from '../pipelines.ts';

/** Sizes the dispatches over the visible chunks. */
export const planCull = {
  stage: 'plan-cull',
  entryPoint: 'planCull',
  bindings: {
    cullParameters: [0, 'uniform'],
    chunkOffsets: [1, 'read'],
    pagePlans: [2, 'read-write'],
    slotCount: [3, 'read-write'],
    cullDispatches: [4, 'read-write'],
    depthRange: [5, 'read-write'],
  },
} as const satisfies StageDefinition;
