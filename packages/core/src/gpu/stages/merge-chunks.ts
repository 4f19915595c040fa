import source from '../../../../../shaders/stages/merge-chunks.wgsl?raw';
import { LEVEL_CONSTANTS, LEVEL_STRUCTS } from '../../data/layout/level-structs.ts';
import type { GeometryPrecision } from '../../data/packing/precision.ts';
import type { StageDefinition } from '../pipelines.ts';
import { LEVEL_LIBRARIES } from './level-libraries.ts';

/** Merges the splats of each chunk of a page, or the roots of each level above ('upper'). */
export function mergeChunks(from: GeometryPrecision | 'upper'): StageDefinition {
  return {
    stage: 'merge-chunks',
    source,
    structs: LEVEL_STRUCTS,
    libraries: LEVEL_LIBRARIES,
    entryPoint: 'mergeChunks',
    // Blobs are float32.
    conditions: { GEOMETRY_F32: from !== 'packed', UPPER: from === 'upper' },
    constants: LEVEL_CONSTANTS,
  };
}
