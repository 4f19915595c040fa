import type { StageDefinition } from '../pipelines.ts';

/** Tests each chunk of a page against the frustum. */
export const cullChunks: StageDefinition = {
  stage: 'cull-chunks',
  entryPoint: 'cullChunks',
};
