import { LEVEL_CONSTANTS } from '../data/layout/level-structs.ts';
import { isAlwaysDrawn, linkParts } from './level-link.ts';

const { ERROR_BOUNDLESS } = LEVEL_CONSTANTS;

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
