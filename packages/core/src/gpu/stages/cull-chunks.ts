import { LEVEL_CONSTANTS } from '../../data/layout/level-structs.ts';
import { computeStage, type StageDefinition } from '../pipelines.ts';
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
  return computeStage('cull-chunks', {
    ...((hasLevels || isInstanced) && { source: levelSource('cull-chunks') }),
    conditions: { LEVELS: hasLevels, INSTANCES: isInstanced },
    constants: {
      ...(hasLevels && LEVEL_CONSTANTS),
      ...(isInstanced && { BATCH_INSTANCES: batchInstances }),
    },
  });
}
