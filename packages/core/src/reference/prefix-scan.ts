/** Reference of prefix-scan: n + 1 exclusive sums of n counts, modulo 2^32, the total last. */
export function prefixScan(counts: ArrayLike<number>): Uint32Array {
  const sums = new Uint32Array(counts.length + 1);
  for (let i = 0; i < counts.length; i++) sums[i + 1] = sums[i] + counts[i];
  return sums;
}
