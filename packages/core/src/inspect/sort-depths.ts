import { sortDistance } from '../data/layout/depth-key.ts';
import { referenceOf } from './compare-records.ts';
import { projectionErrors } from './error-bounds.ts';
import type { InspectedFrame } from './inspected-frame.ts';
import { readRecords } from './read-records.ts';

/** Bounds of the sort depth of a visible splat. */
export interface SortDepth {
  readonly least: number;
  readonly most: number;
}

/**
 * Sort depths of the frame's visible splats, in the order of `visibleSplats`: the depths of their
 * records, to the bit, or the reference's distances (`sortDistance`), which the GPU's may miss by
 * their rounding.
 */
export async function sortDepths(frame: InspectedFrame): Promise<SortDepth[]> {
  const records = await readRecords(frame);
  if (!frame.plan.shape.sortsByDistance)
    return records.map(({ depthView }) => ({ least: depthView, most: depthView }));
  return records.map(({ splat }) => {
    const { cloud, index } = frame.locate(splat);
    const reference = referenceOf(frame, cloud, index);
    // It should not have been drawn; that is for others to find.
    if (!reference) return { least: 0, most: Number.POSITIVE_INFINITY };
    const distance = Math.hypot(...reference.centerView);
    const bound = projectionErrors(cloud.stored, index, cloud.view, frame.projection).distance;
    const { near } = frame.projection;
    return {
      least: sortDistance(Math.max(0, distance - bound), near),
      most: sortDistance(distance + bound, near),
    };
  });
}
