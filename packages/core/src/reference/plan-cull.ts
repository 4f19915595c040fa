/** Chunks of a page, counted through all pages of the frame; `chunkEnd` is the first after it. */
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
 * Reference of plan-cull: distributes the slots of the visible chunks over the pages.
 *
 * @param flags 1 for each visible chunk, 0 for the others.
 * @returns the slots of each page, their number in total, and the numbers of workgroups, one per
 *   slot, that cull the splats of each page and, last, that list the visible splats of all pages.
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
