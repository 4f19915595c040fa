import { computeStage, type StageDefinition } from '../pipelines.ts';

/** Lists the visible splats of the frame in storage order. */
export const compactSplats: StageDefinition = /* @__PURE__ */ computeStage('compact-splats');
