import { LEVEL_CONSTANTS } from '../../data/layout/level-structs.ts';
import { isAlwaysDrawn, isDrawnAt, linkParts, threshold } from '../../reference/level-link.ts';

const { CUT_BINS, ERROR_BOUNDLESS, LEAST_SHIFT, SHIFT_NONE } = LEVEL_CONSTANTS;

/** The parts of `CutParameters` that thresholds follow from. */
export interface CutValues {
  readonly camera: ArrayLike<number>;
  readonly squaredPerDistance: number;
  readonly leastSquared: number;
  readonly margin: number;
}

/** Reference of cut-cells: the threshold of a cell with these bounds of centres. */
export function cellThreshold(
  { min, max }: { readonly min: ArrayLike<number>; readonly max: ArrayLike<number> },
  { camera, squaredPerDistance, leastSquared, margin }: CutValues,
): number {
  const apart = [0, 1, 2].map((axis) =>
    Math.max(0, Math.max(min[axis] - camera[axis], camera[axis] - max[axis]) - margin),
  );
  const distance2 = apart.reduce((sum, each) => sum + each * each, 0);
  return threshold(Math.max(distance2 * squaredPerDistance, leastSquared));
}

/**
 * Reference of plan-cut: the least shift from `leastShift` on from which on all shifts draw at most
 * `budget`; the last one if it draws more.
 *
 * @param countAt number of splats and blobs that a shift draws.
 */
export function planCut(countAt: (shift: number) => number, leastShift: number, budget: number): number {
  const first = Math.max(leastShift, LEAST_SHIFT);
  const counts = Array.from({ length: CUT_BINS }, (_, bin) => countAt(first + bin));
  return first + Math.min(counts.findLastIndex((count) => count > budget) + 1, CUT_BINS - 1);
}

/** A chunk of splats or blobs. */
export interface CountedChunk {
  /** Thresholds of its cell and of the cell above, before any shift; null at the top. */
  readonly limit: number;
  readonly parentLimit: number | null;
  /** Largest error of the cell's roots. */
  readonly cellError: number;
  /** Links of the splats or blobs in sight. */
  readonly links: readonly number[];
}

/** Reference of cut-cells with a budget: a shifted threshold. */
export function shifted(limit: number, shift: number): number {
  return Math.min(Math.max(limit + shift - SHIFT_NONE, 0), ERROR_BOUNDLESS - 1);
}

/** Reference of cut-count: how many splats and blobs a cut at `shift` draws in these chunks. */
export function cutCount(chunks: readonly CountedChunk[], shift: number): number {
  return chunks.reduce((sum, { limit, parentLimit, cellError, links }) => {
    const isOpen = parentLimit === null || shifted(parentLimit, shift) < cellError;
    const drawn = links.filter(
      (link) => link !== 0 && !isAlwaysDrawn(link) && isDrawnAt(link, shifted(limit, shift)),
    );
    return isOpen ? sum + drawn.length : sum;
  }, 0);
}

/** Reference of cut-splats: which of the splats with these links a cut at `limit` goes through. */
export function cutSplats(links: readonly number[], limit: number): boolean[] {
  return links.map((link) => isDrawnAt(link, limit));
}

/** Links of a cell by slot; 0 for slots that hold nothing. */
interface LinkedCell {
  readonly leaves: readonly number[];
  readonly blobs: readonly number[];
}

interface TouchedCell extends LinkedCell {
  readonly isTouched: boolean;
  /** Splats that budgets do not count. */
  readonly uncounted: number;
}

/** Reference of touch-links, exact, for one cell: which of its leaves are drawn one by one, or hidden. */
export function touchCell(
  { leaves, blobs }: LinkedCell,
  isTouched: (slot: number) => boolean,
  isHidden: (slot: number) => boolean,
): TouchedCell {
  const above = new Set<number>();
  for (const [leaf, link] of leaves.entries()) {
    if (link === 0 || !isTouched(leaf)) continue;
    let { parentSlot: slot } = linkParts(link);
    above.add(slot);
    while (linkParts(blobs[slot]).parentError < ERROR_BOUNDLESS) {
      slot = linkParts(blobs[slot]).parentSlot;
      above.add(slot);
    }
  }
  const refined = (link: number, isGone: boolean) => {
    if (link === 0) return 0;
    const parts = linkParts(link);
    const error = isGone ? ERROR_BOUNDLESS : parts.error;
    const parentError = above.has(parts.parentSlot) ? ERROR_BOUNDLESS : parts.parentError;
    return error + parentError * 2 ** 12 + parts.parentSlot * 2 ** 24;
  };
  const refinedLeaves = leaves.map((link, slot) => refined(link, isHidden(slot)));
  return {
    leaves: refinedLeaves,
    blobs: blobs.map((link, slot) => refined(link, above.has(slot))),
    isTouched: above.size > 0,
    uncounted: refinedLeaves.filter((link, slot) => link !== 0 && (isHidden(slot) || isAlwaysDrawn(link)))
      .length,
  };
}

/** The leaves of a cell above the chunks. */
export interface OpenLeaves {
  /** By place; 0 for places without a leaf. */
  readonly links: readonly number[];
  readonly leastError: number;
  readonly uncounted: number;
}

/**
 * Reference of open-leaves, exact.
 *
 * @param errors errors of the cells below; 0 for cells that are not on the GPU.
 */
export function openLeaves(links: readonly number[], errors: readonly number[]): OpenLeaves {
  const opened = links.map((link, place) => {
    if (link === 0) return 0;
    const { parentError, parentSlot } = linkParts(link);
    const error = errors[Math.floor(place / LEVEL_CONSTANTS.CELL_ROOTS)];
    return error + parentError * 2 ** 12 + parentSlot * 2 ** 24;
  });
  const own = opened.filter((link) => link !== 0).map((link) => linkParts(link).error);
  const closed = own.filter((error) => error === 0).length;
  return {
    links: opened,
    leastError: Math.min(...own),
    uncounted: closed > 0 ? links.length - closed : 0,
  };
}
