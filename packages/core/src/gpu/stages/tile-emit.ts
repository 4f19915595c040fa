import { computeStage, type StageDefinition } from '../pipelines.ts';
import { tileSource } from '../shaders/later-source.ts';
import { type SortShape, sortConstants } from './sort-shape.ts';
import { type TileListVariant, tileListConditions } from './tile-count.ts';

/** Lists pairs, and counts the digits of their keys for the first pass of a sort of this shape. */
export function tileEmit(variant: TileListVariant, shape: SortShape): StageDefinition {
  return computeStage('tile-emit', {
    source: tileSource('tile-emit'),
    conditions: tileListConditions(variant),
    constants: sortConstants(shape),
  });
}
