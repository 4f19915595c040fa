import { sortHistogram } from './sort-histogram.ts';
import { sortScan } from './sort-scan.ts';
import { sortScatter } from './sort-scatter.ts';

/** Division of keys into digits and blocks. */
export interface RadixSortShape {
  readonly digitBits: number;
  readonly passes: number;
  readonly blockKeys: number;
}

/** Reference of the radix sort: indices of keys in ascending order, equal keys in given order. */
export function radixSort(keys: ArrayLike<number>, shape: RadixSortShape): Uint32Array {
  let sorted: ReturnType<typeof sortScatter> = {
    keys: Uint32Array.from(keys),
    payloads: Uint32Array.from(keys, (_, i) => i),
  };
  for (let index = 0; index < shape.passes; index++) {
    const pass = { ...shape, digitShift: index * shape.digitBits };
    const places = sortScan(sortHistogram(sorted.keys, pass), shape.digitBits);
    sorted = sortScatter(sorted.keys, sorted.payloads, places, pass);
  }
  return sorted.payloads;
}
