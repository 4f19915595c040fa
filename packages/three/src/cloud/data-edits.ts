import type { PackedCloud, SplatCloud, TimeRange } from '@websplatter/core';
import type { Box3, Vector3 } from 'three/webgpu';

/** Splats on one engine. */
export interface Place {
  readonly cloud: SplatCloud | Promise<SplatCloud>;
  /** The cloud lives as long as it has some. */
  readonly users: Map<object, unknown>;
}

/** Data with their edits and the places where they are. */
export interface PlacedData {
  readonly name: string;
  readonly edits: DataEdits | null;
  /** Null if they stand still. */
  readonly timeRange: TimeRange | null;
  /** Splats in memory, without edits; null if they are on engines alone. */
  readonly packed: PackedCloud | null;
  readonly places: Iterable<Place>;
}

/** Interface of edits, a morph, bones or GPU buffers that `SplatData` uses; own-data.ts implements it. */
export interface DataEdits {
  /** What the data have or are, for messages. */
  readonly what: 'has edits' | 'is a morph' | 'has a skeleton' | 'is made by the GPU';
  /** Number of changes so far. */
  readonly version: number;
  /** Bounds of the centres before any edit. */
  readonly uneditedBounds: Box3;
  /**
   * Applies all edits, also later ones, to `cloud`, which holds the splats on an engine.
   *
   * @param packed the splats as they were uploaded; if given, edits are applied at once.
   */
  follow(cloud: SplatCloud, packed?: PackedCloud): Promise<void>;
  /** Uploads pending edits of `cloud` now instead of before its next frame. */
  flush(cloud: SplatCloud): void;
  /**
   * Sets `center` to the edited centre of the splat of a row; leaves it unchanged without edits.
   *
   * @param place index of the splat in storage order.
   */
  move(row: number, center: Vector3, place: number): void;
}
