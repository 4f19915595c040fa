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
export function tileCount(variant: TileListVariant) {
  return {
    stage: 'tile-count',
    source: tileSource('tile-count'),
    entryPoint: 'tileCount',
    conditions: tileListConditions(variant),
    bindings: {
      view: [0, 'uniform'],
      grid: [1, 'uniform'],
      visibleCount: [2, 'read'],
      order: [3, 'read'],
      records: [4, 'read'],
      pairOffsets: [5, 'read-write'],
      blockPairs: [6, 'read-write'],
    },
  } as const satisfies StageDefinition;
}
