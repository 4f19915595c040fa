import { computeStage, type StageDefinition } from '../pipelines.ts';

/** Sizes the dispatches and the draw over the visible splats. */
export const planProject: StageDefinition = /* @__PURE__ */ computeStage('plan-project');
