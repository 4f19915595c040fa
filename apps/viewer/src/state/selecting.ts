/**
 * Rows of clouds by `cloudKeys`: bit `row % 32` of word `row / 32`, never changed in place. Clouds
 * without a row are absent.
 */
export type RowMasks = ReadonlyMap<string, Uint32Array<ArrayBuffer>>;

/** Tool of a drag over the picture; null turns the camera. */
export type SelectTool = 'rectangle' | 'brush' | null;

/** How a new selection joins the one before. */
export type SelectMode = 'replace' | 'add' | 'subtract';

/** A part of the image, CSS px from its top left. */
export type DragRegion =
  | {
      readonly kind: 'rectangle';
      readonly from: readonly [number, number];
      readonly to: readonly [number, number];
    }
  /** All that is no further than `radius` from the line through the points: x, y, x, y … */
  | { readonly kind: 'brush'; readonly points: readonly number[]; readonly radius: number };

/** Splats that are selected, and those that are neither drawn nor saved. None is both. */
export interface SplatEdit {
  readonly selected: RowMasks;
  readonly removed: RowMasks;
}

export interface Selecting extends SplatEdit {
  readonly tool: SelectTool;
  readonly mode: SelectMode;
  /** CSS px. */
  readonly brushRadius: number;
  /** The region being dragged over the picture. */
  readonly dragged: DragRegion | null;
  /** Whether the selection is saved, and not all that is left. */
  readonly savesSelection: boolean;
}

export const NOTHING_SELECTED: Selecting = {
  selected: new Map(),
  removed: new Map(),
  tool: 'rectangle',
  mode: 'replace',
  brushRadius: 20,
  dragged: null,
  savesSelection: false,
};
