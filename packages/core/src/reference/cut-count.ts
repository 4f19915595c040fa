import { LEVEL_CONSTANTS } from '../data/layout/level-structs.ts';
import { isAlwaysDrawn, isDrawnAt } from './level-link.ts';

const { ERROR_BOUNDLESS, SHIFT_NONE } = LEVEL_CONSTANTS;

/** A chunk of splats or blobs. */
export interface CountedChunk {
  /** Thresholds of its cell and of the cell above, before any shift; null at the top. */
  readonly limit: number;
  readonly parentLimit: number | null;
  /** Largest error of the cell's roots. */
  readonly cellError: number;
  /** Of the splats or blobs that are in sight. */
  readonly links: readonly number[];
}

/** Reference of cut-cells with a budget: a threshold that is shifted. */
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
