import type { StageDefinition } from '../gpu/pipelines.ts';
import type { SortShape } from './sort-shape.ts';

/** Moves keys and payloads to their places; the first pass makes the payloads, the last leaves the keys behind. */
export function sortScatter({ digitBits, workgroup, itemsPerThread }: SortShape) {
  return {
    stage: 'sort-scatter',
    entryPoint: 'sortScatter',
    constants: {
      DIGIT_BITS: digitBits,
      SORT_WORKGROUP: workgroup,
      SORT_ITEMS: itemsPerThread,
      SORT_TILE: workgroup * itemsPerThread,
    },
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
