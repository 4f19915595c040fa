import { LEVEL_CONSTANTS } from '../../data/layout/level-structs.ts';
import type { StageDefinition } from '../pipelines.ts';
import { levelSource } from '../shaders/later-source.ts';
import type { CullSplatsVariant } from './cull-splats.ts';

/**
 * Tests each chunk of a page, or of all instances of a page, against the frustum; with levels, also
 * whether the cut goes through it.
 */
export function cullChunks({
  hasLevels = false,
  batchInstances = null,
}: Pick<CullSplatsVariant, 'hasLevels' | 'batchInstances'> = {}): StageDefinition {
  const isInstanced = batchInstances !== null;
  return {
    stage: 'cull-chunks',
    ...((hasLevels || isInstanced) && { source: levelSource('cull-chunks') }),
    entryPoint: 'cullChunks',
    conditions: { LEVELS: hasLevels, INSTANCES: isInstanced },
    constants: {
      ...(hasLevels && LEVEL_CONSTANTS),
      ...(isInstanced && { BATCH_INSTANCES: batchInstances }),
    },
  };
}
