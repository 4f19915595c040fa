import { SHADER_CONSTANTS } from '../layout/constants.ts';
import type { PageSlots } from './plan-cull.ts';

/**
 * Twin of the GPU's plan-project: shares out the visible splats among the pages.
 *
 * @param splatCounts visible splats of each visible chunk.
 * @returns where each page's splats lie among all visible ones, how many there are in all, and the workgroups that project
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
