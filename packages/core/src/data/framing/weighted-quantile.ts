const BINS = 256;
const bins = new Float64Array(BINS);

/**
 * The value below which this part of the weight lies, to 1/65,536 of the range of the values.
 *
 * @param count the first so many of both count.
 * @param part 0…1.
 */
export function weightedQuantile(
  values: ArrayLike<number>,
  weights: ArrayLike<number>,
  count: number,
  part: number,
): number {
  let low = Number.POSITIVE_INFINITY;
  let high = Number.NEGATIVE_INFINITY;
  let total = 0;
  for (let i = 0; i < count; i++) {
    const value = values[i];
    if (value < low) low = value;
    if (value > high) high = value;
    total += weights[i];
  }
  let below = 0;
  for (let pass = 0; pass < 2; pass++) {
    if (!(high > low)) return low;
    const scale = BINS / (high - low);
    bins.fill(0);
    for (let i = 0; i < count; i++) {
      const value = values[i];
      if (value >= low && value <= high)
        bins[Math.min(BINS - 1, Math.floor((value - low) * scale))] += weights[i];
    }
    let bin = 0;
    while (bin < BINS - 1 && below + bins[bin] < part * total) below += bins[bin++];
    [low, high] = [low + bin / scale, low + (bin + 1) / scale];
  }
  return (low + high) / 2;
}
