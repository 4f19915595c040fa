import type { BinGrid } from '../data/layout/bin-grid.ts';
import { wholeShift } from './tile-grid.ts';

/** Sums stop here. */
const MOST_PAIRS = 2 ** 30;
/** Room that is left for what the estimate of larger bins' pairs lacks. */
const SPARE = 0.8;

/** Decision about one frame, as tile-plan writes it. */
export interface PairPlan {
  /** Per block of ranks: pairs before it. */
  readonly blockStarts: readonly number[];
  readonly neededPairs: number;
  /** Pairs of bins of that size; none if they do not fit, or are to be counted again. */
  readonly pairCount: number;
  readonly fits: boolean;
  readonly binShift: number;
  /** Splats that the quads draw. */
  readonly quads: number;
}

interface PlanOptions {
  readonly visibleCount: number;
  readonly pairCapacity: number;
  readonly grid: BinGrid;
  /** Of pairs that have been counted again: the plan before that. */
  readonly first?: PairPlan;
}

/** Reference of tile-plan. */
export function tilePlan(
  blockPairs: ArrayLike<number>,
  { visibleCount, pairCapacity, grid, first }: PlanOptions,
): PairPlan {
  let total = 0;
  const blockStarts = Array.from(blockPairs, (pairs) => {
    total += pairs;
    return total - pairs;
  });
  const whole = wholeShift(grid);
  const coarser = first ? whole : shiftFor(total, visibleCount, pairCapacity, whole);
  const binShift = total <= pairCapacity ? (first?.binShift ?? 0) : coarser;
  const isRanked = binShift > 0 && binShift === whole;
  const isKnown = first !== undefined || binShift === 0 || isRanked;
  const wanted = isRanked ? visibleCount : total;
  const fits = isKnown && wanted <= pairCapacity;
  return {
    blockStarts,
    neededPairs: first?.neededPairs ?? total,
    pairCount: fits ? wanted : 0,
    fits,
    binShift,
    quads: fits ? 0 : visibleCount,
  };
}

function shiftFor(total: number, visibleCount: number, pairCapacity: number, whole: number): number {
  const pairs = Math.min(total, MOST_PAIRS);
  for (let shift = 1; shift < whole; shift++) {
    const edges = (2 * Math.sqrt(visibleCount * pairs)) / 2 ** shift;
    if (pairs / 4 ** shift + edges + visibleCount <= SPARE * pairCapacity) return shift;
  }
  return whole;
}
