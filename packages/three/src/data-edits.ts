import type { PackedCloud, SplatCloud } from '@websplatter/core';
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
  readonly places: Iterable<Place>;
}

/** The part of the edits of data, or of their morph, that the data know: see own-data.ts. */
export interface DataEdits {
  /** Grows with every change. */
  readonly version: number;
  /** Bounds of the centres before any edit. */
  readonly uneditedBounds: Box3;
  /**
   * Makes `cloud`, which holds the splats on an engine, follow the edits.
   *
   * @param packed the splats as they were uploaded; the cloud follows at once then.
   */
  follow(cloud: SplatCloud, packed?: PackedCloud): Promise<void>;
  /** Uploads the edits that `cloud` follows now instead of before its next frame. */
  flush(cloud: SplatCloud): void;
  /**
   * Sets `center`, of the splat of a row, to where edits have moved it, if they have.
   *
   * @param place of the splat in storage.
   */
  move(row: number, center: Vector3, place: number): void;
}
