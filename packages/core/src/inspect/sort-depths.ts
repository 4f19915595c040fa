import { sortDistance } from '../data/layout/depth-key.ts';
import { hasWideKeys } from '../frame/plan/frame-shape.ts';
import { sortDepth } from '../stages/wide-keys/wide-keys.reference.ts';
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
 * Sort depths of the frame's visible splats in float32, in the order of `visibleSplats`: the depths
 * of their records, to the bit, or the reference's distances (`sortDistance`), which the GPU's may
 * miss by their rounding.
 */
export async function sortDepths(frame: InspectedFrame): Promise<SortDepth[]> {
  const records = await readRecords(frame);
  if (!frame.plan.shape.sortsByDistance)
    return records.map(({ depthView }) => ({ least: depthView, most: depthView }));
  return records.map(({ splat }) => {
    const { cloud, index } = frame.locate(splat);
    const reference = referenceOf(frame, cloud, index);
    // Wrongly drawn: `compareCulling` reports it.
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

/**
 * The depths that the frame's visible splats are sorted by, in the order of `visibleSplats`. Without
 * wide keys, as `sortDepths`. With wide keys, the reference's `sortDepth`: exact, unless effects move
 * splats, which the GPU does in float32.
 */
export async function orderedDepths(frame: InspectedFrame): Promise<SortDepth[]> {
  const { shape } = frame.plan;
  if (!hasWideKeys(shape)) return sortDepths(frame);
  return (await readRecords(frame)).map(({ splat }) => {
    const { cloud, index } = frame.locate(splat);
    const reference = referenceOf(frame, cloud, index);
    // Wrongly drawn: `compareCulling` reports it.
    if (!reference) return { least: 0, most: Number.POSITIVE_INFINITY };
    const depth = sortDepth(reference.centerView, shape.sortsByDistance);
    if (!cloud.effects.some(({ changeSplat }) => changeSplat)) return { least: depth, most: depth };
    const { depthView, distance } = projectionErrors(cloud.stored, index, cloud.view, frame.projection);
    if (!shape.sortsByDistance) return { least: depth - depthView, most: depth + depthView };
    const length = Math.sqrt(depth);
    return { least: Math.max(0, length - distance) ** 2, most: (length + distance) ** 2 };
  });
}
