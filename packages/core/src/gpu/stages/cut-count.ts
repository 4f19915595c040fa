import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { LEVEL_CONSTANTS } from '../../data/layout/level-structs.ts';
import { NARROW_SUBGROUP } from '../device.ts';
import { computeStage, type StageDefinition } from '../pipelines.ts';
import { levelSource } from '../shaders/later-source.ts';
import type { CullSplatsVariant } from './cull-splats.ts';
import type { SortDevice } from './sort-shape.ts';

/** What the shapes of the stage follow from. */
type CountingDevice = Pick<SortDevice, 'isNarrow'>;

/** Chunks that a workgroup counts: few, so that all of a GPU has work; some for each thread alone. */
function countedChunks({ isNarrow }: CountingDevice): number {
  return isNarrow ? 8 * NARROW_SUBGROUP : 8;
}

/** Counts what cuts through a page would draw, by how far their thresholds are shifted. */
export function cutCount({
  geometryPrecision,
  culling,
  batchInstances = null,
  sortDevice,
}: Pick<CullSplatsVariant, 'geometryPrecision' | 'culling' | 'batchInstances'> & {
  readonly sortDevice: CountingDevice;
}): StageDefinition {
  return computeStage('cut-count', {
    source: levelSource('cut-count'),
    conditions: {
      GEOMETRY_F32: geometryPrecision === 'f32',
      FRUSTUM_CULLING: culling === 'frustum',
      NARROW: sortDevice.isNarrow,
      INSTANCES: batchInstances !== null,
    },
    constants: {
      ...LEVEL_CONSTANTS,
      ...(batchInstances !== null && { BATCH_INSTANCES: batchInstances }),
      COUNTED_CHUNKS: countedChunks(sortDevice),
      COUNT_WORKGROUP: sortDevice.isNarrow ? NARROW_SUBGROUP : CHUNK_SPLATS,
    },
  });
}

/** Workgroups for a page of so many chunks. */
export function countWorkgroups(chunkCount: number, device: CountingDevice): number {
  return Math.ceil(chunkCount / countedChunks(device));
}
