import type { PackedCloud } from '../../data/packing/packed-cloud.ts';
import type { GeometryPrecision, ShPrecision } from '../../data/packing/precision.ts';
import type { RowLayout } from '../../data/packing/row-layout.ts';
import type { PackedView } from '../containers/meshopt.ts';
import type { RowFiles } from '../formats/row-sink.ts';
import type { PostedError } from '../posted-error.ts';
import type { KnownSource } from '../sources/known-source.ts';
import type { LoadProgress, SourceOptions } from '../sources/splat-source.ts';

/** Settings of a load besides its source. All can be posted. */
export interface LoadSettings extends SourceOptions {
  readonly shPrecision: ShPrecision;
  readonly geometryPrecision: GeometryPrecision;
}

/** Page to worker. */
export type LoadRequest =
  /** A job. The next one follows only after the outcome of this one. */
  | {
      readonly kind: 'load';
      readonly source: KnownSource;
      readonly settings: LoadSettings;
      /** Limits of the files that are posted as raw rows; null to post no rows. */
      readonly rows: RowFiles | null;
    }
  /** Row memory that the page returns for reuse. */
  | { readonly kind: 'memory'; readonly memory: ArrayBuffer };

/** Worker to page. */
export type LoadReply =
  /**
   * The worker's script is running. The job is posted only now, because posted streams cannot be
   * taken back.
   */
  | { readonly kind: 'ready' }
  | { readonly kind: 'progress'; readonly progress: LoadProgress }
  | { readonly kind: 'cloud'; readonly cloud: PackedCloud }
  /**
   * The page can use the file's rows unchanged. Pieces of rows follow, then an optional note, then
   * the end.
   */
  | { readonly kind: 'layout'; readonly layout: RowLayout }
  | { readonly kind: 'rows'; readonly memory: ArrayBuffer; readonly rowCount: number }
  | { readonly kind: 'rows-note'; readonly text: string }
  | { readonly kind: 'rows-end' }
  /** A compressed part of the file whose decoder only the page can fetch. */
  | { readonly kind: 'packed-view'; readonly view: PackedView; readonly reply: MessagePort }
  /** The file is no PLY. `stream` replaces a stream source and starts at its first byte. */
  | { readonly kind: 'other-format'; readonly stream: ReadableStream<Uint8Array> | null }
  | { readonly kind: 'error'; readonly error: PostedError };

/** Page to worker, through the port of a packed view. */
export type UnpackedReply =
  | { readonly bytes: Uint8Array<ArrayBuffer> | null }
  | { readonly error: PostedError };
