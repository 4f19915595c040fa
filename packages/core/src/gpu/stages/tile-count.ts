import type { Extent, RecordPrecision } from '../../data/accuracy/accuracy.ts';
import { computeStage, type StageDefinition } from '../pipelines.ts';
import { tileSource } from '../shaders/later-source.ts';
import { recordConditions } from './format-conditions.ts';

/** Settings that decide which bins and tiles a splat may touch. */
export interface TileListVariant {
  readonly recordPrecision: RecordPrecision;
  readonly extent: Extent;
  /** Whether splats may be merged ones, with opacities above 1; default false. */
  readonly isStacked?: boolean;
}

/** Conditions of linking for the stages that list pairs. */
export function tileListConditions({ recordPrecision, extent, isStacked = false }: TileListVariant) {
  return { ...recordConditions(recordPrecision), FIXED_EXTENT: extent === 'fixed', STACKED: isStacked };
}

/**
 * Counts the pairs of each visible splat.
 *
 * @param isAgain whether to count those of larger bins, if the plan has them.
 */
export function tileCount(variant: TileListVariant, isAgain = false): StageDefinition {
  return computeStage('tile-count', {
    source: tileSource('tile-count'),
    conditions: { ...tileListConditions(variant), RECOUNT: isAgain },
  });
}
