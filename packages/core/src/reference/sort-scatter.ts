import { prefixScan } from './prefix-scan.ts';
import { digitOf, type SortPass } from './sort-histogram.ts';
import type { DigitPlaces } from './sort-scan.ts';

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
