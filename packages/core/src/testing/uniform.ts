import fc from 'fast-check';

/**
 * Numbers spread evenly over min…max, with the ends, zero and some very small ones among them. fast-check's own spread
 * evenly over all bit patterns, so that nearly all are tiny and matrices of them nearly zero.
 */
export function uniform(min: number, max: number): fc.Arbitrary<number> {
  const steps = 2 ** 30;
  const even = fc.integer({ min: 0, max: steps }).map((step) => min + ((max - min) * step) / steps);
  return fc.oneof(
    { weight: 8, arbitrary: even },
    { weight: 1, arbitrary: fc.double({ min, max, noNaN: true }) },
    { weight: 1, arbitrary: fc.constantFrom(min, max) },
  );
}
