import type { StageDefinition } from '../gpu/pipelines.ts';
import { type SortShape, sortConstants } from './sort-shape.ts';

/** Moves keys and payloads to their places; the first pass makes the payloads, the last leaves the keys behind. */
export function sortScatter(shape: SortShape) {
  return {
    stage: 'sort-scatter',
    entryPoint: 'sortScatter',
    constants: sortConstants(shape),
    bindings: {
      parameters: [0, 'uniform'],
      plan: [1, 'read'],
      digitOffsets: [2, 'read'],
      keysIn: [3, 'read'],
      payloadsOut: [4, 'read-write'],
      payloadsIn: [5, 'read'],
      keysOut: [6, 'read-write'],
    },
  } as const satisfies StageDefinition;
}
