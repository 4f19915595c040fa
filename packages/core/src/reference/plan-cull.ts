/** Chunks of one page, counting through all pages of the frame; `chunkEnd` is the first that is not in it. */
export interface PageChunks {
  readonly chunkStart: number;
  readonly chunkEnd: number;
}

/** Places of a page's visible chunks in the list of all visible chunks. */
export interface PageSlots {
  readonly slotStart: number;
  readonly slotCount: number;
}

/**
 * Twin of the GPU's plan-cull: shares out the slots of the visible chunks among the pages.
 *
 * @param flags 1 for each visible chunk, 0 for the others.
 * @returns the slots of each page, how many there are in all, and the workgroups, one per slot, that cull the splats of
 *   each page and, last, list those of all pages.
 */
export function planCull(flags: ArrayLike<number>, pages: readonly PageChunks[]) {
  const visibleChunks = (start: number, end: number) =>
    Array.from(flags)
      .slice(start, end)
      .filter((flag) => flag === 1).length;
  const slots = pages.map(
    ({ chunkStart, chunkEnd }): PageSlots => ({
      slotStart: visibleChunks(0, chunkStart),
      slotCount: visibleChunks(chunkStart, chunkEnd),
    }),
  );
  const slotCount = visibleChunks(0, flags.length);
  return { slots, slotCount, workgroups: [...slots.map((page) => page.slotCount), slotCount] };
}
