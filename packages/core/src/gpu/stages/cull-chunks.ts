import type { StageDefinition } from '../pipelines.ts';

/** Tests each chunk of a page against the frustum. */
export const cullChunks = {
  stage: 'cull-chunks',
  entryPoint: 'cullChunks',
  bindings: {
    view: [0, 'uniform'],
    page: [1, 'uniform'],
    chunks: [2, 'read'],
    chunkOffsets: [3, 'read-write'],
  },
} as const satisfies StageDefinition;
