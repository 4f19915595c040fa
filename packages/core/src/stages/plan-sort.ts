import type { StageDefinition } from '../gpu/pipelines.ts';

/** Sizes the passes of the sort by the number of keys. */
export function planSort(tileKeys: number) {
  return {
    stage: 'plan-sort',
    entryPoint: 'planSort',
    constants: { SORT_TILE: tileKeys },
    bindings: {
      parameters: [0, 'uniform'],
      keyCount: [1, 'read'],
      plan: [2, 'read-write'],
      digitCountCount: [3, 'read-write'],
      tileDispatch: [4, 'read-write'],
    },
  } as const satisfies StageDefinition;
}
