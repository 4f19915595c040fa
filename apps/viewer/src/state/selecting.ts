import type { Vec3 } from './vec3.ts';

/**
 * Rows of clouds by `cloudKeys`: bit `row % 32` of word `row / 32`, never changed in place. Clouds
 * without a row are absent.
 */
export type RowMasks = ReadonlyMap<string, Uint32Array<ArrayBuffer>>;

/** Tools that select by a pointer over the picture, with the keys of their commands. */
export const SELECT_TOOLS = [
  { name: 'rectangle', label: 'Rectangle', key: '1' },
  { name: 'brush', label: 'Brush', key: '2' },
  { name: 'polygon', label: 'Polygon', key: '3' },
  { name: 'sphere', label: 'Sphere', key: '4' },
  { name: 'color', label: 'Colour', key: '5' },
] as const;

export type SelectTool = (typeof SELECT_TOOLS)[number]['name'];

/** How a new selection joins the one before. */
export type SelectMode = 'replace' | 'add' | 'subtract';

/** A part of the image with its border, CSS px from its top left. */
export type DragRegion =
  | {
      readonly kind: 'rectangle';
      readonly from: readonly [number, number];
      readonly to: readonly [number, number];
    }
  /** All that is no further than `radius` from the line through the points: x, y, x, y … */
  | { readonly kind: 'brush'; readonly points: readonly number[]; readonly radius: number }
  /** Corners: x, y, x, y … Places that its line goes around an even number of times are outside. */
  | { readonly kind: 'polygon'; readonly points: readonly number[] };

/** A part of the scene around a splat that was picked. */
export type PickedRegion =
  /** A ball with its surface, in the scene's own space. */
  | { readonly kind: 'sphere'; readonly center: Vec3; readonly radius: number }
  /** Splats none of whose channels is further than `tolerance` from a base colour; in 255ths. */
  | { readonly kind: 'color'; readonly color: Vec3; readonly tolerance: number };

/** Kinds of splats that are mostly mistakes of a training. */
export type FloaterFilter = 'far' | 'huge' | 'faint' | 'needle';

/** Selected splats, and removed ones, which are neither drawn nor saved. No splat is both. */
export interface SplatEdit {
  readonly selected: RowMasks;
  readonly removed: RowMasks;
}

export interface Selecting extends SplatEdit {
  /** Null turns the camera. */
  readonly tool: SelectTool | null;
  readonly mode: SelectMode;
  /** CSS px. */
  readonly brushRadius: number;
  /** Radius of the next sphere, scene units; null before the first one. */
  readonly sphereRadius: number | null;
  /** Tolerance of the next colour, 0…255. */
  readonly tolerance: number;
  /** The region being drawn over the picture; a polygon's last point goes with the pointer. */
  readonly dragged: DragRegion | null;
  /** The region that is selected, to be changed until the next edit. */
  readonly picked: PickedRegion | null;
  /** Whether the selection is saved, and not all that is left. */
  readonly savesSelection: boolean;
}

export const NOTHING_SELECTED: Selecting = {
  selected: new Map(),
  removed: new Map(),
  tool: 'rectangle',
  mode: 'replace',
  brushRadius: 20,
  sphereRadius: null,
  tolerance: 16,
  dragged: null,
  picked: null,
  savesSelection: false,
};

/** Counts the bits of each mask once. */
const counts = new WeakMap<Uint32Array, number>();

/** Number of rows in the masks. */
export function countOf(masks: RowMasks): number {
  let sum = 0;
  for (const words of masks.values()) {
    const count = counts.get(words) ?? words.reduce((bits, word) => bits + bitsIn(word), 0);
    counts.set(words, count);
    sum += count;
  }
  return sum;
}

/** Adds neighbouring bits, then pairs, then fours; the product adds the four bytes. */
function bitsIn(word: number): number {
  const pairs = word - ((word >>> 1) & 0x55555555);
  const fours = (pairs & 0x33333333) + ((pairs >>> 2) & 0x33333333);
  return Math.imul((fours + (fours >>> 4)) & 0x0f0f0f0f, 0x01010101) >>> 24;
}
