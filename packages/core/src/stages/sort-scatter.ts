import type { BindingKind, StageDefinition } from '../gpu/pipelines.ts';
import type { SortShape } from './sort-shape.ts';

/** Moves keys and payloads to their places; the first pass makes the payloads, the last leaves the keys behind. */
export function sortScatter(
  { digitBits, workgroup, itemsPerThread }: SortShape,
  isFirst: boolean,
  isLast: boolean,
): StageDefinition {
  const bindings: Record<string, readonly [number, BindingKind]> = {
    parameters: [0, 'uniform'],
    plan: [1, 'read'],
    digitOffsets: [2, 'read'],
    keysIn: [3, 'read'],
    payloadsOut: [4, 'read-write'],
  };
  if (!isFirst) bindings.payloadsIn = [5, 'read'];
  if (!isLast) bindings.keysOut = [6, 'read-write'];
  return {
    stage: 'sort-scatter',
    entryPoint: 'sortScatter',
    conditions: { FIRST_PASS: isFirst, LAST_PASS: isLast },
    constants: {
      DIGIT_BITS: digitBits,
      SORT_WORKGROUP: workgroup,
      SORT_ITEMS: itemsPerThread,
      SORT_TILE: workgroup * itemsPerThread,
    },
    bindings,
  };
}
