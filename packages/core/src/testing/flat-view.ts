import type { SizePx } from '../data/accuracy/accuracy.ts';
import { View } from '../data/layout/structs.ts';

/** The fields of `View` that stages after `project` read. */
export interface FlatView {
  readonly size: SizePx;
  readonly alphaCutoff: number;
  readonly dispatchRow: number;
}

/** Packs a `View` for stages that read records: fields for projection are neutral. */
export function packFlatView({ size: { widthPx, heightPx }, alphaCutoff, dispatchRow }: FlatView) {
  return View.pack({
    sizePx: [widthPx, heightPx],
    focalPx: [1, 1],
    centerPx: [0, 0],
    clampX: [0, 0],
    clampY: [0, 0],
    near: 0,
    far: 1,
    alphaCutoff,
    dilationPx2: 0,
    dispatchRow,
  });
}
