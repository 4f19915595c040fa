import { LEVEL_CONSTANTS } from '../../data/layout/level-structs.ts';
import type { StageDefinition } from '../pipelines.ts';
import { levelSource } from '../shaders/later-source.ts';
import type { CullSplatsVariant } from './cull-splats.ts';

/** Counts what cuts through a page would draw, by how far their thresholds are shifted. */
export function cutCount({
  geometryPrecision,
  culling,
}: Pick<CullSplatsVariant, 'geometryPrecision' | 'culling'>): StageDefinition {
  return {
    stage: 'cut-count',
    source: levelSource('cut-count'),
    entryPoint: 'cutCount',
    conditions: { GEOMETRY_F32: geometryPrecision === 'f32', FRUSTUM_CULLING: culling === 'frustum' },
    constants: LEVEL_CONSTANTS,
  };
}

/** Workgroups for a page of so many chunks. */
export function countWorkgroups(chunkCount: number): number {
  return Math.ceil(chunkCount / LEVEL_CONSTANTS.COUNTED_CHUNKS);
}
