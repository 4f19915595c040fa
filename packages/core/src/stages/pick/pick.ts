import type { RecordPrecision } from '../../data/accuracy/accuracy.ts';
import { PICK_CONSTANTS, PICK_STRUCTS } from '../../data/layout/pick-structs.ts';
import { computeStage, type StageDefinition } from '../../gpu/pipelines.ts';
import { familyTexts } from '../family-texts.ts';
import { recordConditions } from '../format-conditions.ts';

const texts = /* @__PURE__ */ familyTexts(
  import.meta.glob('./*.wgsl', { query: '?raw', import: 'default', eager: true }),
  PICK_STRUCTS,
);

/**
 * Blends the splats over one pixel, per block of the drawing order.
 *
 * @param isStacked whether splats may be merged ones, with opacities above 1; default false.
 */
export function pick(recordPrecision: RecordPrecision, isStacked = false): StageDefinition {
  return computeStage('pick', {
    texts,
    constants: PICK_CONSTANTS,
    conditions: { ...recordConditions(recordPrecision), STACKED: isStacked },
  });
}
