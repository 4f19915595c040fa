import { InvalidArgumentError } from '../../data/errors.ts';
import { given, wrongArgument } from '../../data/given.ts';
import { checkPrecision } from '../../data/packing/check-precision.ts';
import type { CloudPrecision } from '../../data/packing/precision.ts';
import { printable } from '../../data/printable.ts';
import type {
  LastingSource,
  OpenedSource,
  SceneFiles,
  SourceOptions,
  SplatFrame,
  SplatSource,
} from './splat-source.ts';

/** Longest name in messages: data URLs can have megabytes. */
const MAX_NAME_LENGTH = 200;

interface SourceNames {
  /** Name for messages: the caller's, else the URL or the file's own. */
  readonly name: string;
  /** Names from which to detect the format, without folders and queries: the caller's, then the file's own. */
  readonly fileNames: readonly string[];
}

/**
 * A source whose kind is known. Functions that users call find it out once, by `knownSource`; this object then goes
 * to whatever opens the source, in this thread or in a worker.
 */
export type KnownSource = SourceNames &
  (
    | {
        readonly kind: 'url';
        /** Absolute, unless it is invalid: a worker would resolve it against its own script. */
        readonly url: string;
      }
    | { readonly kind: 'blob'; readonly blob: Blob }
    /** `leadingPath` checks them; one path for each. */
    | ({ readonly kind: 'files' } & Required<SceneFiles>)
    | { readonly kind: 'frame'; readonly frame: SplatFrame }
    | { readonly kind: 'stream'; readonly stream: ReadableStream<Uint8Array> }
    /** `bytesOf` checks them when they are read: callers may transfer them away meanwhile. */
    | { readonly kind: 'bytes'; readonly bytes: ArrayBuffer | ArrayBufferView }
  );

/**
 * Finds out what a caller's source is, and checks the options of its read. `format` and `request` are checked where
 * their code is: by the readers of all formats, and where a request is made.
 *
 * @throws InvalidArgumentError for wrong options, or if the source is neither a string nor an object.
 */
export function knownSource(
  source: SplatSource,
  options: SourceOptions & Partial<CloudPrecision> = {},
): KnownSource {
  const { format, name, maxBytes, maxSplats = 1 } = given(options, { name: 'a string?' });
  checkPrecision(options);
  for (const [limit, value] of Object.entries({ maxBytes: maxBytes ?? 1, maxSplats }))
    if (!(typeof value === 'number' && value > 0)) throw wrongArgument(limit, value, 'a number above 0');
  const names = (ownName: string, fileName?: unknown): SourceNames => ({
    name: name ?? ownName,
    fileNames: format === undefined ? lastParts([name, fileName]) : [`.${format}`],
  });
  if (typeof source === 'string' || source instanceof URL) {
    const url = String(source);
    return { ...names(shortName(url), addressName(url)), kind: 'url', url: absoluteUrl(url) };
  }
  if (isStream(source)) return { ...names('stream'), kind: 'stream', stream: source };
  if (isBlob(source)) {
    const { name: fileName } = source as Partial<File>;
    return { ...names(shortName(fileName ?? 'blob'), fileName), kind: 'blob', blob: source };
  }
  if (isFiles(source)) {
    const { files, paths = files.map(ownPath) } = source;
    return { ...names('files'), kind: 'files', files: [...files], paths: [...paths] };
  }
  if (isFrame(source)) return { ...names(source.name, source.name), kind: 'frame', frame: source };
  const bytes = Object(source) === source ? source : bytesOf(source);
  return { ...names('buffer'), kind: 'bytes', bytes };
}

/** Names of the file that opening a source has found. */
export function namesOfOpened({ fetched, fileName }: Pick<OpenedSource, 'fetched' | 'fileName'>): string[] {
  return lastParts([fetched && addressName(fetched.url), fileName]);
}

/** The path of an address, by which its file is named; empty for addresses that name none. */
export function addressName(address: string): string {
  return /^(?:blob|data):/i.test(address) ? '' : address.replace(/[?#].*$/s, '');
}

function lastParts(paths: readonly unknown[]): string[] {
  return paths.flatMap((path) => (typeof path === 'string' ? path.replace(/^.*[/\\]/s, '') : []));
}

/**
 * A source that can be read repeatedly: the absolute URL, or the same Blob or Files. Null for
 * streams, which are consumed, and for buffers, which would occupy memory.
 *
 * @throws InvalidArgumentError if the value is neither a string nor an object.
 * @example
 * const source = lastingSource('/garden.ply'); // the absolute URL
 */
export function lastingSource(source: SplatSource): LastingSource | null {
  return lastingOf(knownSource(source));
}

/** See `lastingSource`. */
export function lastingOf(source: KnownSource): LastingSource | null {
  switch (source.kind) {
    case 'url':
      return source.url;
    case 'blob':
      return source.blob;
    case 'frame':
      return source.frame;
    case 'files':
      return { files: source.files, paths: source.paths };
    default:
      return null;
  }
}

/** `text` for messages, shortened if it is long. */
export function shortName(text: string): string {
  const shown = printable(text);
  return shown.length <= MAX_NAME_LENGTH ? shown : `${shown.slice(0, MAX_NAME_LENGTH)}…`;
}

/** Base URL for relative URLs; undefined outside of a page. */
export function baseUrl(): string | undefined {
  return typeof document === 'undefined' ? globalThis.location?.href : document.baseURI;
}

function absoluteUrl(url: string): string {
  const base = baseUrl();
  return URL.canParse(url, base) ? new URL(url, base).href : url;
}

function isStream(source: unknown): source is ReadableStream<Uint8Array> {
  return typeof (source as Partial<ReadableStream>)?.getReader === 'function';
}

export function isBlob(source: unknown): source is Blob {
  const blob = source as Partial<Blob> | null;
  return typeof blob?.stream === 'function' && typeof blob.size === 'number';
}

/** Whether `source` has a `files` list; its items are not checked. */
function isFiles(source: unknown): source is SceneFiles {
  return Array.isArray((source as Partial<SceneFiles> | null)?.files);
}

/** Files lose their paths when they are posted. */
export function ownPath(file: Partial<File> | null): string {
  return file?.webkitRelativePath || (file?.name ?? '');
}

function isFrame(source: unknown): source is SplatFrame {
  return typeof (source as Partial<SplatFrame> | null)?.loadFrame === 'function';
}

/** The bytes of a buffer or of a view, without a copy. Throws `InvalidArgumentError` for anything else. */
export function bytesOf(source: ArrayBuffer | ArrayBufferView): Uint8Array {
  // By tag, because a buffer may come from another realm (an iframe, a test runner).
  const tag = Object.prototype.toString.call(source).slice(8, -1);
  try {
    if (ArrayBuffer.isView(source))
      return new Uint8Array(source.buffer, source.byteOffset, source.byteLength);
    if (tag === 'ArrayBuffer' || tag === 'SharedArrayBuffer') return new Uint8Array(source);
  } catch {
    throw new InvalidArgumentError(
      'source',
      `source is a ${tag} that has been transferred away; pass it before, or a copy.`,
    );
  }
  const expected = 'it must be a URL, Blob, File, { files }, ArrayBuffer, view or ReadableStream';
  throw new InvalidArgumentError('source', `source is ${tag}; ${expected}.`);
}
