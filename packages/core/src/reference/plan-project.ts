import { SHADER_CONSTANTS } from '../data/layout/constants.ts';
import type { PageSlots } from './plan-cull.ts';

/**
 * Reference of plan-project: distributes the visible splats over the pages.
 *
 * @param splatCounts number of visible splats of each visible chunk.
 * @param visibleCapacity most splats to distribute; the last ones are left out.
 * @returns the range of each page among all visible splats, their number in total, and the number
 *   of workgroups that project each page.
 */
export function planProject(
  splatCounts: ArrayLike<number>,
  pages: readonly PageSlots[],
  visibleCapacity: number,
) {
  const splatsBefore = (slot: number) =>
    Math.min(
      visibleCapacity,
      Array.from(splatCounts)
        .slice(0, slot)
        .reduce((sum, count) => sum + count, 0),
    );
  const splats = pages.map(({ slotStart, slotCount }) => ({
    visibleStart: splatsBefore(slotStart),
    visibleCount: splatsBefore(slotStart + slotCount) - splatsBefore(slotStart),
  }));
  return {
    splats,
    visibleCount: splatsBefore(splatCounts.length),
    workgroups: splats.map(({ visibleCount }) =>
      Math.ceil(visibleCount / SHADER_CONSTANTS.PROJECT_WORKGROUP),
    ),
  };
}
