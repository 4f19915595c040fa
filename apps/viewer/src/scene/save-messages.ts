import type { CropBox } from '@websplatter/core/write';
import type { LastingScene } from '../engine/lasting-scene.ts';
import type { SavingState } from '../state/saving.ts';
import type { Placement } from '../state/scene-part.ts';
import type { UpAxis } from '../state/up-axis.ts';

/** A set of a file's rows, which are either the only rows saved or left out. */
export interface SavedRows {
  /** Bit `row % 32` of word `row / 32` is set if the row is in the set. */
  readonly words: Uint32Array<ArrayBuffer>;
  readonly areSaved: boolean;
}

/** A file of a scene, and how it is drawn. */
export interface SavedPart {
  readonly source: LastingScene;
  /** Null if the file is placed as it was saved. */
  readonly placement: Placement | null;
  /** Above 0, at most 1. */
  readonly opacity: number;
  /** Which rows are saved; null: all. */
  readonly rows: SavedRows | null;
}

export interface SaveRequest {
  readonly kind: 'save';
  /** One or more; their splats are written one after another. */
  readonly parts: readonly SavedPart[];
  /** One of `WRITABLE_FORMATS`. */
  readonly formatName: string;
  /** The axis of the scene that is shown upwards. */
  readonly up: UpAxis;
  /** The part of the scene to save, in the scene's own space; null: all of it. */
  readonly crop: CropBox | null;
}

export type SaveReply =
  | ({ readonly kind: 'progress' } & Pick<SavingState, 'phase' | 'part'>)
  /** `notes`: data that the format cannot store. */
  | { readonly kind: 'done'; readonly bytes: Uint8Array<ArrayBuffer>; readonly notes: readonly string[] }
  /** `isFault`: the error is a defect, not a refusal that was thrown on purpose. */
  | { readonly kind: 'failed'; readonly message: string; readonly isFault: boolean };
