import { LEVEL_CONSTANTS } from './level-structs.ts';

const { CELL_CHILDREN, CELL_ROOTS } = LEVEL_CONSTANTS;

/** Number of cells at each level, from one per chunk up to the single root cell. */
export function cellCounts(chunkCount: number): number[] {
  const counts = [chunkCount];
  while (counts.at(-1)! > 1) counts.push(Math.ceil(counts.at(-1)! / CELL_CHILDREN));
  return counts;
}

/** The cell of the level below whose root is a leaf of this one. */
export function childCell(
  counts: readonly number[],
  { cell, slot }: { readonly cell: number; readonly slot: number },
): number {
  let [level, start] = [0, 0];
  while (cell >= start + counts[level]) start += counts[level++];
  return start - counts[level - 1] + CELL_CHILDREN * (cell - start) + Math.floor(slot / CELL_ROOTS);
}
