import { prefixScan } from './prefix-scan.ts';
import { sortHistogram } from './sort-histogram.ts';
import { sortScatter } from './sort-scatter.ts';

/** Division of keys into digits and tiles. */
export interface RadixSortShape {
  readonly digitBits: number;
  readonly passes: number;
  readonly tileKeys: number;
}

/** Twin of the radix sort: the index of each key in ascending order of keys, equal keys in their given order. */
export function radixSort(keys: ArrayLike<number>, shape: RadixSortShape): Uint32Array {
  let sorted: ReturnType<typeof sortScatter> = {
    keys: Uint32Array.from(keys),
    payloads: Uint32Array.from(keys, (_, i) => i),
  };
  for (let index = 0; index < shape.passes; index++) {
    const pass = { ...shape, digitShift: index * shape.digitBits };
    const offsets = prefixScan(sortHistogram(sorted.keys, pass));
    sorted = sortScatter(sorted.keys, sorted.payloads, offsets, pass);
  }
  return sorted.payloads;
}
