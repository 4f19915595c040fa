import { computeStage, type StageDefinition } from '../pipelines.ts';
import { tileSource } from '../shaders/later-source.ts';
import { type SortShape, sortConstants } from './sort-shape.ts';

/**
 * Decides how large bins are, so that their pairs fit, and sizes the stages that follow.
 *
 * @param isAgain whether to do so once more, if pairs have been counted again.
 */
export function tilePlan(shape: SortShape, isAgain = false): StageDefinition {
  return computeStage('tile-plan', {
    source: tileSource('tile-plan'),
    entryPoint: 'planTiles',
    constants: sortConstants(shape),
    conditions: { RECOUNT: isAgain },
  });
}
