import source from '../../../../../shaders/stages/pick.wgsl?raw';
import type { RecordPrecision } from '../../data/accuracy/accuracy.ts';
import { PICK_CONSTANTS, PICK_STRUCTS } from '../../data/layout/pick-structs.ts';
import type { StageDefinition } from '../pipelines.ts';
import { recordConditions } from './format-conditions.ts';

/** Blends the splats over one pixel, per block of the drawing order. */
export function pick(recordPrecision: RecordPrecision) {
  return {
    stage: 'pick',
    source,
    structs: PICK_STRUCTS,
    constants: PICK_CONSTANTS,
    entryPoint: 'pick',
    conditions: recordConditions(recordPrecision),
    bindings: {
      view: [0, 'uniform'],
      parameters: [1, 'uniform'],
      visibleCount: [2, 'read'],
      order: [3, 'read'],
      visibleSplats: [4, 'read'],
      records: [5, 'read'],
      blocks: [6, 'read-write'],
    },
  } as const satisfies StageDefinition;
}
