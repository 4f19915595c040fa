import { computeStage, type StageDefinition } from '../pipelines.ts';

/** Sizes the dispatches over the visible chunks. */
export const planCull: StageDefinition = /* @__PURE__ */ computeStage('plan-cull');
