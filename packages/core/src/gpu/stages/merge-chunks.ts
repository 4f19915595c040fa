import { LEVEL_CONSTANTS } from '../../data/layout/level-structs.ts';
import type { GeometryPrecision } from '../../data/packing/precision.ts';
import { computeStage, type StageDefinition } from '../pipelines.ts';
import { levelSource } from '../shaders/later-source.ts';

/** Merges the splats of each chunk of a page, or the roots of each level above ('upper'). */
export function mergeChunks(from: GeometryPrecision | 'upper'): StageDefinition {
  return computeStage('merge-chunks', {
    source: levelSource('merge-chunks'),
    // Blobs are float32.
    conditions: { GEOMETRY_F32: from !== 'packed', UPPER: from === 'upper' },
    constants: LEVEL_CONSTANTS,
  });
}
