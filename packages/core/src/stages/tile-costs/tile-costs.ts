import type { RecordPrecision } from '../../data/accuracy/accuracy.ts';
import { computeStage, type StageDefinition } from '../../gpu/pipelines.ts';
import { familyTexts } from '../family-texts.ts';
import { recordConditions } from '../format-conditions.ts';

const texts = /* @__PURE__ */ familyTexts(
  import.meta.glob('./*.wgsl', { query: '?raw', import: 'default', eager: true }),
);

/** Units of contribution per pixel: as fine as float32 tells a weight from 1. */
export const CONTRIBUTION_UNITS = 2 ** 24;
/** A splat that contributes less, px, cannot change any pixel by as much as a step of 8 bits. */
export const UNSEEN_PX = 1 / 256;

/** Planes of a word per pixel that the stage writes. */
export const COST_PLANES = 3;

/**
 * @param pass writes counts and sums of contributions, or a map made from these sums.
 * @param isStacked whether splats may be merged ones, with opacities above 1; default false.
 */
export function tileCosts(
  recordPrecision: RecordPrecision,
  pass: 'counts' | 'map',
  isStacked = false,
): StageDefinition {
  const isMap = pass === 'map';
  return computeStage('tile-costs', {
    texts,
    constants: { CONTRIBUTION_UNITS, UNSEEN_UNITS: UNSEEN_PX * CONTRIBUTION_UNITS },
    conditions: { ...recordConditions(recordPrecision), CONTRIBUTIONS: isMap, STACKED: isStacked },
  });
}
