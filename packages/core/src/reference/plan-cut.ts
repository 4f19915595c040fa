import { LEVEL_CONSTANTS } from '../data/layout/level-structs.ts';

const { CUT_BINS, SHIFT_STEP } = LEVEL_CONSTANTS;

/**
 * Reference of plan-cut, after both of its steps: the least shift from `base` on that draws at most
 * `budget`; of those beyond the first of every SHIFT_STEP shifts that does.
 *
 * @param countAt how much a shift draws.
 */
export function planCut(countAt: (shift: number) => number, base: number, budget: number): number {
  const fits = (shift: number) => countAt(shift) <= budget;
  const coarse = Array.from({ length: CUT_BINS }, (_, bin) => base + SHIFT_STEP * bin);
  const bound = coarse.find(fits);
  if (bound === base) return base;
  const first = (bound ?? coarse.at(-1)!) - (SHIFT_STEP - 1);
  const fine = Array.from({ length: CUT_BINS }, (_, bin) => first + bin);
  return fine.find(fits) ?? fine.at(-1)!;
}
