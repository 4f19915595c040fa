import type { StageDefinition } from '../pipelines.ts';

/** Sizes the passes of the sort by the number of keys. */
export function planSort(blockKeys: number): StageDefinition {
  return {
    stage: 'plan-sort',
    entryPoint: 'planSort',
    constants: { SORT_BLOCK: blockKeys },
  };
}
