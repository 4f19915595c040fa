import type { CropBox } from '@websplatter/core/write';
import type { LastingScene } from '../engine/lasting-scene.ts';
import type { SavingState } from '../state/saving.ts';
import type { Placement } from '../state/scene-part.ts';
import type { UpAxis } from '../state/up-axis.ts';

/** Rows of a file, of which only those are saved, or all others. */
export interface SavedRows {
  /** Bit `row % 32` of word `row / 32`. */
  readonly words: Uint32Array<ArrayBuffer>;
  readonly areSaved: boolean;
}

/** A file of a scene, and how it is drawn. */
export interface SavedPart {
  readonly source: LastingScene;
  /** Null where it stands as it was saved. */
  readonly placement: Placement | null;
  /** Above 0, at most 1. */
  readonly opacity: number;
  /** Which of its rows are saved; null: all. */
  readonly rows: SavedRows | null;
}

export interface SaveRequest {
  readonly kind: 'save';
  /** One or more; their splats are written one after another. */
  readonly parts: readonly SavedPart[];
  /** Of `WRITABLE_FORMATS`. */
  readonly formatName: string;
  /** The axis of the scene's own that is shown upwards. */
  readonly up: UpAxis;
  /** The part of the scene to save, in its own space; null: all of it. */
  readonly crop: CropBox | null;
}

export type SaveReply =
  | ({ readonly kind: 'progress' } & Pick<SavingState, 'phase' | 'part'>)
  /** `notes`: what the format does not keep. */
  | { readonly kind: 'done'; readonly bytes: Uint8Array<ArrayBuffer>; readonly notes: readonly string[] }
  /** `isFault`: it was not thrown on purpose. */
  | { readonly kind: 'failed'; readonly message: string; readonly isFault: boolean };
