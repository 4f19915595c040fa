import {
  type FilePlace,
  InvalidArgumentError,
  SplatFileError,
  type SplatFileErrorCode,
  SplatSourceError,
  WebSplatterError,
} from '../../data/errors.ts';
import type { PackedCloud } from '../../data/packing/packed-cloud.ts';
import type { GeometryPrecision, ShPrecision } from '../../data/packing/precision.ts';
import type { RowLayout } from '../../data/packing/row-layout.ts';
import { shown } from '../../data/printable.ts';
import type { PackedView } from '../containers/meshopt.ts';
import type { RowFiles } from '../formats/row-sink.ts';
import type { LoadProgress, SourceOptions, SplatSource } from '../sources/splat-source.ts';

/** Settings of a load besides its source. All can be posted. */
export interface LoadSettings extends SourceOptions {
  readonly shPrecision: ShPrecision;
  readonly geometryPrecision: GeometryPrecision;
  /** See `SplatFormatOptions`. */
  readonly requestsAtOnce?: number;
}

/** Page to worker. */
export type LoadRequest =
  /** A job. The next one follows only after the outcome of this one. */
  | {
      readonly kind: 'load';
      readonly source: SplatSource;
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

/** An error as plain data: structured clone drops classes and fields. */
export interface PostedError {
  readonly className: string;
  readonly message: string;
  readonly code?: string;
  readonly file?: string;
  readonly place?: FilePlace;
  readonly status?: number;
  readonly argument?: string;
  /** Message of the error's cause. */
  readonly cause?: string;
}

export function toPostedError(error: unknown): PostedError {
  if (!(error instanceof Error)) return { className: 'Error', message: shown(error) };
  const { cause: reason } = error;
  const cause = reason instanceof Error ? String(reason) : reason === undefined ? undefined : shown(reason);
  const common = { className: error.name, message: error.message, cause };
  if (error instanceof SplatFileError)
    return { ...common, code: error.code, file: error.file, place: error.place };
  if (error instanceof SplatSourceError) return { ...common, file: error.file, status: error.status };
  if (error instanceof InvalidArgumentError) return { ...common, argument: error.argument };
  if (error instanceof WebSplatterError) return { ...common, code: error.code };
  return common;
}

/** Converts a posted error to its original class. */
export function fromPostedError(posted: PostedError): Error {
  const error = emptyError(posted, posted.cause === undefined ? {} : { cause: posted.cause });
  // Constructors append file and place to a message; this message already has them.
  error.message = posted.message;
  // Chromium and Node begin a stack with the error's first message, and consoles print stacks.
  error.stack = error.stack?.replace(/^\w*Error\b.*/, `${error.name}: ${error.message}`);
  return error;
}

function emptyError(
  { className, code, file = '', place, status, argument = '' }: PostedError,
  options: ErrorOptions,
): Error {
  switch (className) {
    case 'SplatFileError':
      return new SplatFileError(code as SplatFileErrorCode, file, '', place, options);
    case 'SplatSourceError':
      return new SplatSourceError(file, '', status, options);
    case 'InvalidArgumentError':
      return new InvalidArgumentError(argument, '');
    default:
      return code === undefined ? new Error('', options) : new WebSplatterError(code, '', options);
  }
}
