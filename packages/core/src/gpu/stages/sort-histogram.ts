import { computeStage, type StageDefinition } from '../pipelines.ts';
import { type SortShape, sortConstants } from './sort-shape.ts';

/** Counts the digits of each block of keys. */
export function sortHistogram(shape: SortShape): StageDefinition {
  return computeStage('sort-histogram', {
    conditions: { NARROW: shape.isNarrow },
    constants: sortConstants(shape),
  });
}
