import { SHADER_CONSTANTS } from '../layout/constants.ts';
import type { PageSlots } from './plan-cull.ts';

/**
 * Twin of plan-project: distributes the visible splats over the pages.
 *
 * @param splatCounts number of visible splats of each visible chunk.
 * @returns the range of each page among all visible splats, their number in total, and the number of workgroups that project
 *   each page.
 */
export function planProject(splatCounts: ArrayLike<number>, pages: readonly PageSlots[]) {
  const visibleSplats = (start: number, end: number) =>
    Array.from(splatCounts)
      .slice(start, end)
      .reduce((sum, count) => sum + count, 0);
  const splats = pages.map(({ slotStart, slotCount }) => ({
    visibleStart: visibleSplats(0, slotStart),
    visibleCount: visibleSplats(slotStart, slotStart + slotCount),
  }));
  return {
    splats,
    visibleCount: visibleSplats(0, splatCounts.length),
    workgroups: splats.map(({ visibleCount }) =>
      Math.ceil(visibleCount / SHADER_CONSTANTS.PROJECT_WORKGROUP),
    ),
  };
}
