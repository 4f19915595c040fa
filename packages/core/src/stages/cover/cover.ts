import type { RecordPrecision } from '../../data/accuracy/accuracy.ts';
import type { DepthConvention } from '../../data/camera/depth-convention.ts';
import { COVER_CONSTANTS, COVER_STRUCTS } from '../../data/layout/cover-structs.ts';
import { computeStage, type StageDefinition } from '../../gpu/pipelines.ts';
import { familyTexts } from '../family-texts.ts';
import { recordConditions } from '../format-conditions.ts';

const texts = /* @__PURE__ */ familyTexts(
  import.meta.glob('./*.wgsl', { query: '?raw', import: 'default', eager: true }),
  COVER_STRUCTS,
);

/** Threads of a workgroup. */
export const COVER_WORKGROUP = 256;

/**
 * Adds up the splats that cover each of some points.
 *
 * @param compare how the host's depth is compared; null: there is none.
 * @param isStacked whether splats may be merged ones, with opacities above 1; default false.
 */
export function coverPoints(
  recordPrecision: RecordPrecision,
  compare: DepthConvention['compare'] | null,
  isStacked = false,
): StageDefinition {
  return computeStage('cover-points', {
    texts,
    constants: COVER_CONSTANTS,
    conditions: {
      ...recordConditions(recordPrecision),
      STACKED: isStacked,
      DEPTH_TEST: compare !== null,
      REVERSED_DEPTH: compare === 'greater-equal',
    },
  });
}
