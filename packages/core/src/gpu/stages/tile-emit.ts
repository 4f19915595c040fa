import type { StageDefinition } from '../pipelines.ts';
import { tileSource } from '../shaders/later-source.ts';
import { type SortShape, sortConstants } from './sort-shape.ts';
import { type TileListVariant, tileListConditions } from './tile-count.ts';

/** Lists pairs, and counts the digits of their keys for the first pass of a sort of this shape. */
export function tileEmit(variant: TileListVariant, shape: SortShape) {
  return {
    stage: 'tile-emit',
    source: tileSource('tile-emit'),
    entryPoint: 'tileEmit',
    conditions: tileListConditions(variant),
    constants: sortConstants(shape),
    bindings: {
      view: [0, 'uniform'],
      grid: [1, 'uniform'],
      tilePlan: [2, 'read'],
      order: [3, 'read'],
      records: [4, 'read'],
      pairOffsets: [5, 'read'],
      blockPairs: [6, 'read'],
      pairBins: [7, 'read-write'],
      pairRecords: [8, 'read-write'],
      digitCounts: [9, 'read-write'],
    },
  } as const satisfies StageDefinition;
}
