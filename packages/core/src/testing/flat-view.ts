import type { SizePx } from '../data/accuracy/accuracy.ts';
import { CHUNK_SPLATS } from '../data/layout/constants.ts';
import { Page, View } from '../data/layout/structs.ts';

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
    dispatchRow,
  });
}

/** Contents of several structs, one after another. */
export function joined(structs: readonly ArrayBuffer[]): ArrayBuffer {
  const bytes = structs.flatMap((struct) => [...new Uint8Array(struct)]);
  return Uint8Array.from(bytes).buffer;
}

/**
 * Packs a `Page` for stages of levels, which read no more of it than its chunks and, of cut-count,
 * the frustum.
 *
 * @param side all six sides of the frustum.
 */
export function packFlatPage(
  chunkStart: number,
  chunkCount: number,
  side: readonly number[],
  splatCount = chunkCount * CHUNK_SPLATS,
  cellStart = 0,
) {
  return Page.pack({
    linear: new Array(9).fill(0),
    translation: [0, 0, 0],
    dilationPx2: 0,
    camera: [0, 0, 0],
    cameraWeight: 0,
    sight: [1, 0, 0, 0, 1, 0, 0, 0, 1],
    direction: [0, 0, 0],
    cellStart,
    frustum: Array.from({ length: 24 }, (_, i) => side[i % 4]),
    frustumReach: new Array(24).fill(0),
    index: 0,
    chunkStart,
    chunkCount,
    splatCount,
  });
}
