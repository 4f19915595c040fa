/** Scanned digit counts of one pass of a radix sort. */
export interface DigitPlaces {
  /** By digit and block, in the order of `sortHistogram`: the digit's keys in earlier blocks. */
  readonly digitOffsets: Uint32Array;
  /** Number of keys per digit. */
  readonly digitTotals: Uint32Array;
}

/** Reference of sort-scan. */
export function sortScan(digitCounts: ArrayLike<number>, digitBits: number): DigitPlaces {
  const digitTotals = new Uint32Array(2 ** digitBits);
  const blockCount = digitCounts.length / digitTotals.length;
  const digitOffsets = Uint32Array.from(digitCounts, (count, i) => {
    const digit = Math.floor(i / blockCount);
    const offset = digitTotals[digit];
    digitTotals[digit] += count;
    return offset;
  });
  return { digitOffsets, digitTotals };
}
