import type { StageDefinition } from '../pipelines.ts';
import { type SortShape, sortConstants } from './sort-shape.ts';

/** Moves keys and payloads to their places; each pass may make the payloads, and write the keys. */
export function sortScatter(shape: SortShape) {
  return {
    stage: 'sort-scatter',
    entryPoint: 'sortScatter',
    conditions: {
      NARROW: shape.isNarrow,
      SUBGROUPS: shape.subgroups !== null,
      WIDE_SUBGROUPS: (shape.subgroups?.max ?? 0) > 32,
    },
    usesSubgroups: shape.subgroups !== null,
    constants: sortConstants(shape),
    bindings: {
      parameters: [0, 'uniform'],
      plan: [1, 'read'],
      digitOffsets: [2, 'read'],
      digitTotals: [3, 'read'],
      keysIn: [4, 'read'],
      payloadsOut: [5, 'read-write'],
      payloadsIn: [6, 'read'],
      keysOut: [7, 'read-write'],
    },
  } as const satisfies StageDefinition;
}
