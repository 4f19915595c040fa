import type { StageDefinition } from '../gpu/pipelines.ts';
import type { SortShape } from './sort-shape.ts';

/** Counts the digits of each tile of keys. */
export function sortHistogram({ digitBits, workgroup, itemsPerThread }: SortShape) {
  return {
    stage: 'sort-histogram',
    entryPoint: 'sortHistogram',
    constants: {
      DIGIT_BITS: digitBits,
      SORT_WORKGROUP: workgroup,
      SORT_ITEMS: itemsPerThread,
      SORT_TILE: workgroup * itemsPerThread,
    },
    bindings: {
      parameters: [0, 'uniform'],
      plan: [1, 'read'],
      keys: [2, 'read'],
      digitCounts: [3, 'read-write'],
    },
  } as const satisfies StageDefinition;
}
