import { computeStage, type StageDefinition } from '../pipelines.ts';
import { type SortShape, sortConstants } from './sort-shape.ts';

/** Moves keys and payloads to their places; each pass may make the payloads, and write the keys. */
export function sortScatter(shape: SortShape): StageDefinition {
  return computeStage('sort-scatter', {
    conditions: {
      NARROW: shape.isNarrow,
      SUBGROUPS: shape.subgroups !== null,
      WIDE_SUBGROUPS: (shape.subgroups?.max ?? 0) > 32,
    },
    usesSubgroups: shape.subgroups !== null,
    constants: sortConstants(shape),
  });
}
