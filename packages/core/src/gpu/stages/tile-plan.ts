import type { StageDefinition } from '../pipelines.ts';
import { tileSource } from '../shaders/later-source.ts';
import { type SortShape, sortConstants } from './sort-shape.ts';

/** Decides whether the pairs fit, and sizes the stages that follow. */
export function tilePlan(shape: SortShape): StageDefinition {
  return {
    stage: 'tile-plan',
    source: tileSource('tile-plan'),
    entryPoint: 'planTiles',
    constants: sortConstants(shape),
  };
}
