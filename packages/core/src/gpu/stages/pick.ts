import source from '../../../../../shaders/stages/pick.wgsl?raw';
import type { RecordPrecision } from '../../data/accuracy/accuracy.ts';
import { PICK_CONSTANTS, PICK_STRUCTS } from '../../data/layout/pick-structs.ts';
import { computeStage, type StageDefinition } from '../pipelines.ts';
import { recordConditions } from './format-conditions.ts';

/**
 * Blends the splats over one pixel, per block of the drawing order.
 *
 * @param isStacked whether splats may be merged ones, with opacities above 1; default false.
 */
export function pick(recordPrecision: RecordPrecision, isStacked = false): StageDefinition {
  return computeStage('pick', {
    source,
    structs: PICK_STRUCTS,
    constants: PICK_CONSTANTS,
    conditions: { ...recordConditions(recordPrecision), STACKED: isStacked },
  });
}
