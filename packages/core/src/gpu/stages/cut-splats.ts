import { LEVEL_CONSTANTS } from '../../data/layout/level-structs.ts';
import { computeStage, type StageDefinition } from '../pipelines.ts';
import { levelSource } from '../shaders/later-source.ts';

/**
 * Tells which splats or blobs of a page's visible chunks the cut goes through.
 *
 * @param batchInstances most instances that are drawn together; null: the page is drawn once.
 */
export function cutSplats(batchInstances: number | null = null): StageDefinition {
  return computeStage('cut-splats', {
    source: levelSource('cut-splats'),
    conditions: { INSTANCES: batchInstances !== null },
    constants: { ...LEVEL_CONSTANTS, ...(batchInstances !== null && { BATCH_INSTANCES: batchInstances }) },
  });
}

/** Most workgroups for a page of so many chunks, all of which are visible. */
export function cutWorkgroups(chunkCount: number): number {
  return Math.ceil(chunkCount / 32);
}
