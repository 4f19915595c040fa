import type { StageDefinition } from '../pipelines.ts';

/** Sizes the dispatches and the draw over the visible splats. */
export const planProject = {
  stage: 'plan-project',
  entryPoint: 'planProject',
  bindings: {
    cullParameters: [0, 'uniform'],
    splatOffsets: [1, 'read'],
    slotCount: [2, 'read'],
    pagePlans: [3, 'read-write'],
    visibleCount: [4, 'read-write'],
    projectDispatches: [5, 'read-write'],
    drawArguments: [6, 'read-write'],
  },
} as const satisfies StageDefinition;
