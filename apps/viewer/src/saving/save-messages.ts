import type { CropBox } from '@websplatter/core/write';
import type { UpAxis } from '../camera/up-axis.ts';
import type { LastingScene } from '../rereading/lasting-scene.ts';
import type { SavingState } from '../state/saving.ts';

export interface SaveRequest {
  readonly kind: 'save';
  readonly source: LastingScene;
  /** Of `WRITABLE_FORMATS`. */
  readonly formatName: string;
  /** The axis of the scene's own that is shown upwards. */
  readonly up: UpAxis;
  /** What of the scene is saved; null: all of it. */
  readonly crop: CropBox | null;
}

export type SaveReply =
  | ({ readonly kind: 'progress' } & Pick<SavingState, 'phase' | 'part'>)
  | { readonly kind: 'done'; readonly bytes: Uint8Array<ArrayBuffer> }
  /** `isFault`: nobody threw it on purpose. */
  | { readonly kind: 'failed'; readonly message: string; readonly isFault: boolean };
