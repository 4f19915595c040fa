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

/** Settings of a load besides its source; all of them can be posted. */
export interface LoadSettings extends SourceOptions {
  readonly shPrecision: ShPrecision;
  readonly geometryPrecision: GeometryPrecision;
  /** See `SplatFormatOptions`. */
  readonly requestsAtOnce?: number;
}

/** Page to worker. */
export type LoadRequest =
  /** A job. The next one comes after the outcome of this one. */
  | {
      readonly kind: 'load';
      readonly source: SplatSource;
      readonly settings: LoadSettings;
      /** Which files are posted as rows, if they are of that kind; null: none. */
      readonly rows: RowFiles | null;
    }
  /** Memory of rows that the page has taken, to be used again. */
  | { readonly kind: 'memory'; readonly memory: ArrayBuffer };

/** Worker to page. */
export type LoadReply =
  /** The worker's script runs. The job is posted only now: posted streams cannot be taken back. */
  | { readonly kind: 'ready' }
  | { readonly kind: 'progress'; readonly progress: LoadProgress }
  | { readonly kind: 'cloud'; readonly cloud: PackedCloud }
  /** The file has rows that the page takes as they are; they follow in pieces, then a note if any, and their end. */
  | { readonly kind: 'layout'; readonly layout: RowLayout }
  | { readonly kind: 'rows'; readonly memory: ArrayBuffer; readonly rowCount: number }
  | { readonly kind: 'rows-note'; readonly text: string }
  | { readonly kind: 'rows-end' }
  /** A part of the file that takes code to unpack which only the page can fetch. */
  | { readonly kind: 'packed-view'; readonly view: PackedView; readonly reply: MessagePort }
  /** The file is no PLY. A stream goes on, from its beginning, with the one given back. */
  | { readonly kind: 'other-format'; readonly stream: ReadableStream<Uint8Array> | null }
  | { readonly kind: 'error'; readonly error: PostedError };

/** Page to worker, by the port of a packed view. */
export type UnpackedReply =
  | { readonly bytes: Uint8Array<ArrayBuffer> | null }
  | { readonly error: PostedError };

/** An error as plain data: structured clone keeps neither classes nor fields. */
export interface PostedError {
  readonly className: string;
  readonly message: string;
  readonly code?: string;
  readonly file?: string;
  readonly place?: FilePlace;
  readonly status?: number;
  readonly argument?: string;
  /** The cause's message. */
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

/** Turns a posted error back into one of its own class. */
export function fromPostedError(posted: PostedError): Error {
  const error = emptyError(posted, posted.cause === undefined ? {} : { cause: posted.cause });
  // Constructors add file and place to a message; this message has them already.
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
