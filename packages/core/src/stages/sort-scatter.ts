import type { StageDefinition } from '../gpu/pipelines.ts';
import { type SortShape, sortConstants } from './sort-shape.ts';

/** Moves keys and payloads to their places. The first pass makes the payloads; the last does not write the keys. */
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
