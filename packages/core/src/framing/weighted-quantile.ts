const BINS = 256;
/** One more for the highest value. */
const bins = new Float64Array(BINS + 1);

/**
 * The values below which these parts of the weight lie, to 1/65,536 of the range of all values.
 *
 * @param count the first so many of both count, at least one.
 * @param parts 0…1.
 */
export function weightedQuantiles(
  values: Float64Array,
  weights: Float64Array,
  count: number,
  parts: readonly number[],
): number[] {
  let low = values[0];
  let high = values[0];
  let total = 0;
  for (let i = 0; i < count; i++) {
    const value = values[i];
    if (value < low) low = value;
    if (value > high) high = value;
    total += weights[i];
  }
  if (!(high > low)) return parts.map(() => low);
  fillBins(values, weights, count, low, high);
  const step = (high - low) / BINS;
  const coarse = parts.map((part) => findBin(part * total, 0));
  return coarse.map(({ bin, below }, i) => {
    const from = low + bin * step;
    fillBins(values, weights, count, from, from + step);
    return from + ((findBin(parts[i] * total, below).bin + 0.5) * step) / BINS;
  });
}

/** The value below which this part of the weight lies: see `weightedQuantiles`. */
export function weightedQuantile(
  values: Float64Array,
  weights: Float64Array,
  count: number,
  part: number,
): number {
  return weightedQuantiles(values, weights, count, [part])[0];
}

function fillBins(
  values: Float64Array,
  weights: Float64Array,
  count: number,
  low: number,
  high: number,
): void {
  const scale = BINS / (high - low);
  bins.fill(0);
  for (let i = 0; i < count; i++) {
    const place = (values[i] - low) * scale;
    if (place >= 0 && place <= BINS) bins[place | 0] += weights[i];
  }
}

/** The bin at which so much weight is reached, if the bins before the first have `below`. */
function findBin(weight: number, below: number): { readonly bin: number; readonly below: number } {
  let bin = 0;
  let sum = below;
  while (bin < BINS && sum + bins[bin] < weight) sum += bins[bin++];
  return { bin, below: sum };
}
