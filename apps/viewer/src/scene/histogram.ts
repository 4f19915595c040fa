import type { Histogram } from '../state/inspecting.ts';

const OPACITY_BINS = 20;
/** How finely a decade may be divided: by roots of ten, so that edges meet at powers of ten. */
const DECADE_PARTS = [1, 2, 5, 10, 20, 50, 100];
/** More bins than that are narrower than a finger's width of the panel can show. */
const MOST_BINS = 40;
/** Scales count down to this many decades below the largest: no camera tells more apart. */
const MOST_DECADES = 8;

export function opacityEdges(): number[] {
  return Array.from({ length: OPACITY_BINS + 1 }, (_, i) => i / OPACITY_BINS);
}

/** Edges at equal ratios around `least`…`most`, powers of ten included; a decade for no extent. */
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

/** The bin of `value`; values beyond either end belong to the bin there. */
export function binOf(value: number, { edges, isByRatio }: Pick<Histogram, 'edges' | 'isByRatio'>): number {
  const bins = edges.length - 1;
  const place = isByRatio ? Math.log : (each: number) => each;
  const [low, high] = [place(edges[0]), place(edges[bins])];
  const bin = Math.floor((bins * (place(value) - low)) / (high - low));
  return Math.min(bins - 1, Math.max(0, bin));
}

/** The bin in which half of all splats have been counted. */
export function medianBin({ counts }: Pick<Histogram, 'counts'>): number {
  const half = counts.reduce((sum, count) => sum + count, 0) / 2;
  let before = 0;
  return counts.findIndex((count) => {
    before += count;
    return before >= half;
  });
}

/** Height of a count's bar, 0…1: by its logarithm, which shows one splat among millions. */
export function barHeight(count: number, most: number): number {
  return count === 0 ? 0 : Math.log1p(count) / Math.log1p(most);
}
