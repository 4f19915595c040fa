import { LEVEL_CONSTANTS } from '../../data/layout/level-structs.ts';
import type { StageDefinition } from '../pipelines.ts';
import { levelSource } from '../shaders/later-source.ts';

/** Tests each chunk of a page against the frustum. */
export const cullChunks: StageDefinition = {
  stage: 'cull-chunks',
  entryPoint: 'cullChunks',
};

/** The same for a batch of at most so many instances of a page. */
export function cullInstances(batchInstances: number): StageDefinition {
  return {
    ...cullChunks,
    source: levelSource('cull-chunks'),
    conditions: { INSTANCES: true },
    constants: { BATCH_INSTANCES: batchInstances },
  };
}

/** The same for a page with levels, whose chunks are drawn where the cut goes through them. */
export const cullLevels: StageDefinition = {
  ...cullChunks,
  source: levelSource('cull-chunks'),
  conditions: { LEVELS: true },
  constants: LEVEL_CONSTANTS,
};
