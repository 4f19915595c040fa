import type { Extent, RecordPrecision } from '../../data/accuracy/accuracy.ts';
import type { StageDefinition } from '../pipelines.ts';
import { tileSource } from '../shaders/later-source.ts';
import { recordConditions } from './format-conditions.ts';

/** Settings that decide which bins and tiles a splat may touch. */
export interface TileListVariant {
  readonly recordPrecision: RecordPrecision;
  readonly extent: Extent;
}

/** Conditions of linking for the stages that list pairs. */
export function tileListConditions({ recordPrecision, extent }: TileListVariant) {
  return { ...recordConditions(recordPrecision), FIXED_EXTENT: extent === 'fixed' };
}

/** Counts the pairs of each visible splat. */
export function tileCount(variant: TileListVariant): StageDefinition {
  return {
    stage: 'tile-count',
    source: tileSource('tile-count'),
    entryPoint: 'tileCount',
    conditions: tileListConditions(variant),
  };
}
