/**
 * Words of the facts that ingest-rows gathers about the rows that it keeps. Smallest values are kept as the largest
 * complement of `orderedBits`, so that all facts begin at 0.
 */
export const INGEST_FACTS = {
  FACT_MIN_POSITION: 0,
  FACT_MAX_POSITION: 3,
  FACT_MIN_LOG_SCALE: 6,
  FACT_MAX_LOG_SCALE: 7,
  /** 1 if a splat is not round. */
  FACT_STRETCHED: 8,
  /** For each band, the largest sum of squares of a channel's coefficients, as a float. */
  FACT_REACH: 9,
  /** Numbers of rows that were dropped, by reason. */
  FACT_DROPPED: 12,
  FACTS: 17,
} as const;
