import fc from 'fast-check';

/**
 * Arbitrary numbers spread evenly over min…max, including the ends, zero and some very small ones.
 * fast-check's own spread evenly over all bit patterns, so nearly all of them are tiny, and
 * matrices of them nearly zero.
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
