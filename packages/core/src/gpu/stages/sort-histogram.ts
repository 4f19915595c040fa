import type { StageDefinition } from '../pipelines.ts';
import { type SortShape, sortConstants } from './sort-shape.ts';

/** Counts the digits of each block of keys. */
export function sortHistogram(shape: SortShape) {
  return {
    stage: 'sort-histogram',
    entryPoint: 'sortHistogram',
    constants: sortConstants(shape),
    bindings: {
      parameters: [0, 'uniform'],
      plan: [1, 'read'],
      keys: [2, 'read'],
      digitCounts: [3, 'read-write'],
    },
  } as const satisfies StageDefinition;
}
