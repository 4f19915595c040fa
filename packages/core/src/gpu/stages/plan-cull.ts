import type { StageDefinition } from '../pipelines.ts';

/** Sizes the dispatches over the visible chunks. */
export const planCull: StageDefinition = {
  stage: 'plan-cull',
  entryPoint: 'planCull',
};
