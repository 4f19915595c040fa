import type { StageDefinition } from '../pipelines.ts';
import { tileSource } from '../shaders/later-source.ts';
import { type TileListVariant, tileListConditions } from './tile-count.ts';

/** Finds the tiles that each pair may touch. */
export function tileMasks(variant: TileListVariant): StageDefinition {
  return {
    stage: 'tile-masks',
    source: tileSource('tile-masks'),
    entryPoint: 'maskTiles',
    conditions: tileListConditions(variant),
  };
}
