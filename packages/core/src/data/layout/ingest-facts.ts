/**
 * Words of the facts that ingest-rows gathers about the rows that it keeps. Smallest values are
 * kept as the largest complement of `orderedBits`, so that all facts begin at 0.
 */
export const INGEST_FACTS = {
  FACT_MIN_POSITION: 0,
  FACT_MAX_POSITION: 3,
  /** 1 if a splat is not round. */
  FACT_STRETCHED: 6,
  /** For each band, the largest sum of squares of a channel's coefficients, as a float. */
  FACT_REACH: 7,
  /** Numbers of rows that were dropped, by reason. */
  FACT_DROPPED: 10,
  FACTS: 15,
} as const;
