import type { DecodedRecord } from '../inspect/read-records.ts';
import type { VisibleSplat } from '../stages/cull/cull.reference.ts';

/** Converts a record to the reference's visible splat, with the numbers that the GPU reads. */
export function visibleSplatOf(record: DecodedRecord): VisibleSplat {
  const { centerPx, majorPx, minorPx, depthView, color } = record;
  const [[x, y], [minorX, minorY]] = [majorPx, minorPx];
  return {
    depthView,
    centerPx: [centerPx[0], centerPx[1]],
    covariance: {
      a: (x * x + minorX * minorX) / 2,
      b: (x * y + minorX * minorY) / 2,
      c: (y * y + minorY * minorY) / 2,
      determinant: (x * minorY - y * minorX) ** 2 / 4,
    },
    opacity: color[3],
    isStacked: true,
    // The whole image: the cutoff decides.
    extentPx: [1e9, 1e9],
  };
}
