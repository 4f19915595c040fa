import type { Histogram } from '../state/inspecting.ts';

const OPACITY_BINS = 20;
/**
 * Possible numbers of bins per decade: edges are roots of ten, so that they include powers of ten.
 */
const DECADE_PARTS = [1, 2, 5, 10, 20, 50, 100];
/** Most bins: narrower ones would be too small for the panel and a finger. */
const MOST_BINS = 40;
/**
 * Decades below the largest scale that the histogram covers: no camera distinguishes smaller
 * scales.
 */
const MOST_DECADES = 8;

export function opacityEdges(): number[] {
  return Array.from({ length: OPACITY_BINS + 1 }, (_, i) => i / OPACITY_BINS);
}

/**
 * Bin edges with equal ratios around `least`…`most`, including powers of ten. If both are equal,
 * covers one decade.
 */
export function scaleEdges(least: number, most: number): number[] {
  if (!(most > 0 && Number.isFinite(most))) return [0.1, 1];
  const high = Math.log10(most);
  const low = Math.max(Math.log10(least), high - MOST_DECADES);
  const parts =
    DECADE_PARTS.findLast((each) => Math.floor(high * each) - Math.floor(low * each) < MOST_BINS) ?? 1;
  const first = Math.floor(low * parts);
  const last = Math.floor(high * parts) + 1;
  return Array.from({ length: last - first + 1 }, (_, i) => 10 ** ((first + i) / parts));
}

/**
 * Index of the bin of `value`; values outside of the edges are clamped to the first or last bin.
 */
export function binOf(value: number, { edges, isByRatio }: Pick<Histogram, 'edges' | 'isByRatio'>): number {
  const bins = edges.length - 1;
  const place = isByRatio ? Math.log : (each: number) => each;
  const [low, high] = [place(edges[0]), place(edges[bins])];
  const bin = Math.floor((bins * (place(value) - low)) / (high - low));
  return Math.min(bins - 1, Math.max(0, bin));
}

/** Index of the bin that contains the median splat. */
export function medianBin({ counts }: Pick<Histogram, 'counts'>): number {
  const half = counts.reduce((sum, count) => sum + count, 0) / 2;
  let before = 0;
  return counts.findIndex((count) => {
    before += count;
    return before >= half;
  });
}

/** Height of a bar, 0…1, logarithmic in the count: one splat among millions stays visible. */
export function barHeight(count: number, most: number): number {
  return count === 0 ? 0 : Math.log1p(count) / Math.log1p(most);
}
