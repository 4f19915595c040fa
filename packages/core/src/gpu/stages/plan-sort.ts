import type { StageDefinition } from '../pipelines.ts';

/** Sizes the passes of the sort by the number of keys. */
export function planSort(blockKeys: number) {
  return {
    stage: 'plan-sort',
    entryPoint: 'planSort',
    constants: { SORT_BLOCK: blockKeys },
    bindings: {
      parameters: [0, 'uniform'],
      keyCount: [1, 'read'],
      plan: [2, 'read-write'],
      blockDispatch: [3, 'read-write'],
    },
  } as const satisfies StageDefinition;
}
