import { computeStage, type StageDefinition } from '../pipelines.ts';
import { wideKeySource } from '../shaders/later-source.ts';
import { type SortShape, sortConstants } from './sort-shape.ts';

/** Puts the upper words of wide keys into the order of the lower ones. */
export function sortGather(shape: SortShape): StageDefinition {
  return computeStage('sort-gather', {
    source: wideKeySource('sort-gather'),
    conditions: { NARROW: shape.isNarrow },
    constants: sortConstants(shape),
  });
}
