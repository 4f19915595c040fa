import { sortGather } from './sort-gather.ts';
import { sortHistogram } from './sort-histogram.ts';
import { sortScan } from './sort-scan.ts';
import { sortScatter } from './sort-scatter.ts';

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
