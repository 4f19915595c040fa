import { prefixScan } from '../cull/cull.reference.ts';
import { sortGather } from '../wide-keys/wide-keys.reference.ts';

/** Division of keys into digits and blocks. */
export interface RadixSortShape {
  readonly digitBits: number;
  readonly passes: number;
  readonly blockKeys: number;
}

/**
 * Reference of the radix sort: indices of keys in ascending order, equal keys in given order.
 *
 * @param upperKeys the upper words of wide keys; `keys` are their lower ones then, and the first of
 *   the passes sort by these.
 */
export function radixSort(
  keys: ArrayLike<number>,
  shape: RadixSortShape,
  upperKeys?: ArrayLike<number>,
): Uint32Array {
  const wordPasses = 32 / shape.digitBits;
  let sorted: ReturnType<typeof sortScatter> = {
    keys: new Uint32Array(keys),
    payloads: new Uint32Array(keys.length).map((_, i) => i),
  };
  for (let index = 0; index < shape.passes; index++) {
    const isUpper = upperKeys !== undefined && index >= wordPasses;
    if (isUpper && index === wordPasses) sorted = { ...sorted, keys: sortGather(upperKeys, sorted.payloads) };
    const digitShift = (isUpper ? index - wordPasses : index) * shape.digitBits;
    const pass = { ...shape, digitShift };
    const places = sortScan(sortHistogram(sorted.keys, pass), shape.digitBits);
    sorted = sortScatter(sorted.keys, sorted.payloads, places, pass);
  }
  return sorted.payloads;
}

/** Bits of a key that a pass of a radix sort reads, and number of keys that a workgroup takes. */
export interface SortPass {
  readonly digitShift: number;
  readonly digitBits: number;
  readonly blockKeys: number;
}

export function digitOf(key: number, { digitShift, digitBits }: SortPass): number {
  // Shader and reference agree beyond the key's top too: extractBits takes only existing bits.
  return (key >>> digitShift) & ((1 << digitBits) - 1);
}

/** Reference of sort-histogram: counts by digit and block; all blocks of digit 0, then 1, … */
export function sortHistogram(keys: ArrayLike<number>, pass: SortPass): Uint32Array {
  const blockCount = Math.ceil(keys.length / pass.blockKeys);
  const counts = new Uint32Array(blockCount << pass.digitBits);
  for (let i = 0; i < keys.length; i++) {
    counts[digitOf(keys[i], pass) * blockCount + Math.floor(i / pass.blockKeys)]++;
  }
  return counts;
}

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

/** Reference of sort-scatter: a stable pass of a radix sort. `places`: scanned `sortHistogram`. */
export function sortScatter(
  keys: ArrayLike<number>,
  payloads: ArrayLike<number>,
  places: DigitPlaces,
  pass: SortPass,
): { readonly keys: Uint32Array; readonly payloads: Uint32Array } {
  const blockCount = Math.ceil(keys.length / pass.blockKeys);
  const starts = prefixScan(places.digitTotals);
  const next = Uint32Array.from(places.digitOffsets);
  const sorted = { keys: new Uint32Array(keys.length), payloads: new Uint32Array(keys.length) };
  for (let i = 0; i < keys.length; i++) {
    const digit = digitOf(keys[i], pass);
    const place = starts[digit] + next[digit * blockCount + Math.floor(i / pass.blockKeys)]++;
    sorted.keys[place] = keys[i];
    sorted.payloads[place] = payloads[i];
  }
  return sorted;
}
