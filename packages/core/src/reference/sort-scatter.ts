import { digitOf, type SortPass } from './sort-histogram.ts';

/**
 * Twin of sort-scatter: one stable pass of a radix sort.
 *
 * @param digitOffsets scanned counts of `sortHistogram`: the first place for the keys of each digit and tile.
 */
export function sortScatter(
  keys: ArrayLike<number>,
  payloads: ArrayLike<number>,
  digitOffsets: ArrayLike<number>,
  pass: SortPass,
): { readonly keys: Uint32Array; readonly payloads: Uint32Array } {
  const tileCount = Math.ceil(keys.length / pass.tileKeys);
  const next = Uint32Array.from(digitOffsets);
  const sorted = { keys: new Uint32Array(keys.length), payloads: new Uint32Array(keys.length) };
  for (let i = 0; i < keys.length; i++) {
    const place = next[digitOf(keys[i], pass) * tileCount + Math.floor(i / pass.tileKeys)]++;
    sorted.keys[place] = keys[i];
    sorted.payloads[place] = payloads[i];
  }
  return sorted;
}
