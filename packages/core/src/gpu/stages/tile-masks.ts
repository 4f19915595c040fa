import type { StageDefinition } from '../pipelines.ts';
import { tileSource } from '../shaders/later-source.ts';
import { type TileListVariant, tileListConditions } from './tile-count.ts';

/** Finds the tiles that each pair may touch. */
export function tileMasks(variant: TileListVariant) {
  return {
    stage: 'tile-masks',
    source: tileSource('tile-masks'),
    entryPoint: 'maskTiles',
    conditions: tileListConditions(variant),
    bindings: {
      view: [0, 'uniform'],
      grid: [1, 'uniform'],
      tilePlan: [2, 'read'],
      sortedBins: [3, 'read'],
      sortedRecords: [4, 'read'],
      records: [5, 'read'],
      tileMasks: [6, 'read-write'],
    },
  } as const satisfies StageDefinition;
}
