import { pairSortShapeFor, type SortShape, sortShapeFor } from '../stages/sort/sort.ts';
import type { FrameShape } from './frame-shape.ts';

/** Sort of the visible splats by depth. */
export function depthSortShape({ keyBits, sortDevice }: FrameShape): SortShape {
  return sortShapeFor(keyBits, sortDevice);
}

/** Sort of the pairs by bin; one more key than bins, for pairs too many. */
export function pairSortShape({ binCount, sortDevice }: FrameShape): SortShape {
  return pairSortShapeFor(Math.ceil(Math.log2(binCount + 1)), sortDevice);
}
