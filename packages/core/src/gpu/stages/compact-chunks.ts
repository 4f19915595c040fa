import { computeStage, type StageDefinition } from '../pipelines.ts';

/** Lists the visible chunks of the frame in storage order. */
export const compactChunks: StageDefinition = /* @__PURE__ */ computeStage('compact-chunks');
