import { InvalidArgumentError, SplatSourceError } from '../../data/errors.ts';
import { printable } from '../../data/printable.ts';
import type { OpenedSource, SceneFiles, SourceOptions, SplatFrame, SplatSource } from './splat-source.ts';

/** Longest name in messages: data URLs can have megabytes. */
const MAX_NAME_LENGTH = 200;

/** Name of a source in messages, unless the caller gives one. */
export function sourceName(source: SplatSource): string {
  if (typeof source === 'string' || source instanceof URL) return shortName(String(source));
  if (isStream(source)) return 'stream';
  if (isBlob(source)) return shortName((source as Partial<File>).name ?? 'blob');
  if (isFiles(source)) return 'files';
  if (isFrame(source)) return source.name;
  return 'buffer';
}

/**
 * Names from which to detect the format of `source`, without folders and queries. A name made from
 * the caller's `format` replaces all; else the caller's name comes first, then the source's own.
 *
 * @param opened adds names found while opening the source.
 */
export function fileNamesOf(
  source: SplatSource,
  { format, name }: Pick<SourceOptions, 'format' | 'name'>,
  { fetched, fileName }: Pick<OpenedSource, 'fetched' | 'fileName'> = {},
): string[] {
  if (format !== undefined) return [`.${format}`];
  const isAddress = typeof source === 'string' || source instanceof URL;
  const own = isAddress ? addressName(String(source)) : (source as Partial<File> | null)?.name;
  const names = [name, own, fetched && addressName(fetched.url), fileName];
  // Values other than strings are rejected later.
  return names.flatMap((each) => (typeof each === 'string' ? lastPart(each) : []));
}

function addressName(address: string): string {
  return /^(?:blob|data):/i.test(address) ? '' : address.replace(/[?#].*$/s, '');
}

function lastPart(path: string): string {
  return path.replace(/^.*[/\\]/s, '');
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

export function isStream(source: unknown): source is ReadableStream<Uint8Array> {
  return typeof (source as Partial<ReadableStream>)?.getReader === 'function';
}

export function isBlob(source: unknown): source is Blob {
  const blob = source as Partial<Blob> | null;
  return typeof blob?.stream === 'function' && typeof blob.size === 'number';
}

/** Whether `source` has a `files` list; its items are not checked. */
export function isFiles(source: unknown): source is SceneFiles {
  return Array.isArray((source as Partial<SceneFiles> | null)?.files);
}

export function isFrame(source: unknown): source is SplatFrame {
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

export function lockedStreamError(name: string): SplatSourceError {
  return new SplatSourceError(
    name,
    'the stream is locked: something else is reading it, or has read it. Pass a fresh stream, or the Blob or URL itself.',
  );
}
