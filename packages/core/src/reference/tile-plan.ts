/** Decision about one frame, as tile-plan writes it. */
export interface PairPlan {
  /** Per block of ranks: pairs before it. */
  readonly blockStarts: readonly number[];
  readonly neededPairs: number;
  /** All pairs, or none if they do not fit. */
  readonly pairCount: number;
  readonly fits: boolean;
  /** Splats that the quads draw. */
  readonly quads: number;
}

/** Reference of tile-plan. */
export function tilePlan(
  blockPairs: ArrayLike<number>,
  visibleCount: number,
  pairCapacity: number,
): PairPlan {
  let neededPairs = 0;
  const blockStarts = Array.from(blockPairs, (pairs) => {
    neededPairs += pairs;
    return neededPairs - pairs;
  });
  const fits = neededPairs <= pairCapacity;
  return {
    blockStarts,
    neededPairs,
    pairCount: fits ? neededPairs : 0,
    fits,
    quads: fits ? 0 : visibleCount,
  };
}
