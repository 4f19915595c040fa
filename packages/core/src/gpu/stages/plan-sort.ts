import { computeStage, type StageDefinition } from '../pipelines.ts';

/** Sizes the passes of the sort by the number of keys. */
export function planSort(blockKeys: number): StageDefinition {
  return computeStage('plan-sort', {
    constants: { SORT_BLOCK: blockKeys },
  });
}
