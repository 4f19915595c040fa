import type { StageDefinition } from '../pipelines.ts';

/** Lists the visible chunks of the frame in storage order. */
export const compactChunks = {
  stage: 'compact-chunks',
  entryPoint: 'compactChunks',
  bindings: { cullParameters: [0, 'uniform'], chunkOffsets: [1, 'read'], visibleChunks: [2, 'read-write'] },
} as const satisfies StageDefinition;
