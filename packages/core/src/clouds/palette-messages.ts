import type { PostedError } from '../io/loading/load-messages.ts';
import type { PackedHarmonics } from '../packing/harmonics.ts';
import type { HarmonicsPalette } from '../packing/harmonics-palette.ts';

/** Page to worker: the one job of the worker. */
export interface PaletteRequest {
  readonly harmonics: PackedHarmonics;
  /** Number of splats. */
  readonly count: number;
  readonly entryCount: number;
}

/** Worker to page. */
export type PaletteReply =
  /** The worker's script is running. */
  | { readonly kind: 'ready' }
  /** How much of the work is done, 0 to 1. */
  | { readonly kind: 'progress'; readonly part: number }
  | { readonly kind: 'palette'; readonly palette: HarmonicsPalette }
  | { readonly kind: 'error'; readonly error: PostedError };
