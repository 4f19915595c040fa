/** Reference of tile-ranges: the first sorted pair of each bin, and the end of the last. */
export function tileRanges(sortedBins: ArrayLike<number>, binCount: number): Uint32Array {
  const starts = new Uint32Array(binCount + 1);
  for (let i = 0; i < sortedBins.length; i++) if (sortedBins[i] < binCount) starts[sortedBins[i] + 1]++;
  for (let bin = 0; bin < binCount; bin++) starts[bin + 1] += starts[bin];
  return starts;
}
