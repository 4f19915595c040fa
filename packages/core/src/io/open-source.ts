import { InvalidArgumentError, SplatSourceError } from '../errors.ts';
import { printable } from '../printable.ts';
import { lockedStreamError, messageOf } from './byte-reader.ts';
import type { OpenedSource, ReadOptions, SplatSource } from './splat-source.ts';

/** Memory is streamed in pieces of this size, so that reading it does not block a page. */
const PIECE_BYTES = 1 << 20;
/** Longest name shown in messages: data URLs can be megabytes. */
const MAX_NAME_LENGTH = 200;

/**
 * Opens anything that splats can be read from as a stream of bytes. Memory is not copied.
 *
 * Rejects with `SplatSourceError` (network, HTTP status, a stream already in use), with `InvalidArgumentError` for
 * anything that is not a source, and with the signal's reason.
 */
export async function openSource(source: SplatSource, options: ReadOptions = {}): Promise<OpenedSource> {
  options.signal?.throwIfAborted();
  if (typeof source === 'string' || source instanceof URL) return openUrl(String(source), options);
  const { name = sourceName(source) } = options;
  if (isStream(source)) {
    if (source.locked) throw lockedStreamError(name);
    return { name, totalBytes: undefined, totalBytesCertain: false, stream: source };
  }
  if (isBlob(source)) {
    return { name, totalBytes: source.size, totalBytesCertain: true, stream: source.stream() };
  }
  const bytes = bytesOf(source);
  return { name, totalBytes: bytes.length, totalBytesCertain: true, stream: streamOfBytes(bytes) };
}

/** Name of a source in messages, unless the caller gives one. */
export function sourceName(source: SplatSource): string {
  if (typeof source === 'string' || source instanceof URL) return shortName(String(source));
  if (isStream(source)) return 'stream';
  if (isBlob(source)) return shortName((source as Partial<File>).name ?? 'blob');
  return 'buffer';
}

/** `text` as messages show it, shortened if it is long. */
export function shortName(text: string): string {
  const shown = printable(text);
  return shown.length <= MAX_NAME_LENGTH ? shown : `${shown.slice(0, MAX_NAME_LENGTH)}…`;
}

export function isStream(source: unknown): source is ReadableStream<Uint8Array> {
  return typeof (source as Partial<ReadableStream>)?.getReader === 'function';
}

export function isBlob(source: unknown): source is Blob {
  const blob = source as Partial<Blob> | null;
  return typeof blob?.stream === 'function' && typeof blob.size === 'number';
}

/**
 * The bytes of a buffer, or of the part that a view shows, without a copy. Throws `InvalidArgumentError` for anything
 * else.
 */
export function bytesOf(source: ArrayBuffer | ArrayBufferView): Uint8Array {
  // By its tag, since a buffer may come from another realm (an iframe, a test runner).
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
  const expected = 'it must be a URL, Blob, File, ArrayBuffer, view or ReadableStream';
  throw new InvalidArgumentError('source', `source is ${tag}; ${expected}.`);
}

async function openUrl(url: string, { name = shortName(url), signal }: ReadOptions): Promise<OpenedSource> {
  const response = await fetchOrThrow(url, name, signal);
  if (!response.ok) {
    response.body?.cancel().catch(() => {});
    const reason = response.statusText === '' ? '' : ` ${response.statusText}`;
    throw new SplatSourceError(name, `the server answered ${response.status}${reason}`, response.status);
  }
  return {
    name,
    totalBytes: contentLength(response.headers),
    totalBytesCertain: response.type !== 'cors',
    stream: response.body ?? streamOfBytes(new Uint8Array(0)),
  };
}

async function fetchOrThrow(url: string, name: string, signal: AbortSignal | undefined): Promise<Response> {
  try {
    return await fetch(url, { signal });
  } catch (cause) {
    signal?.throwIfAborted();
    throw new SplatSourceError(name, `cannot be fetched: ${fetchFailure(url, cause)}`, undefined, { cause });
  }
}

function fetchFailure(url: string, cause: unknown): string {
  if (typeof document === 'undefined' && (!URL.canParse(url) || url.startsWith('file:'))) {
    return 'outside a page only absolute http, https, data and blob URLs can be; read a local file yourself and pass its Blob or bytes';
  }
  // Node says only "fetch failed", with the reason one level down.
  const reason = cause instanceof Error && cause.cause instanceof Error ? cause.cause : cause;
  return `${messageOf(reason)} (offline, blocked by CORS, or no such host?)`;
}

function contentLength(headers: Headers): number | undefined {
  const encoding = headers.get('content-encoding');
  if (encoding !== null && encoding !== 'identity') return undefined;
  const length = headers.get('content-length');
  return length !== null && /^\d+$/.test(length) ? Number(length) : undefined;
}

function streamOfBytes(bytes: Uint8Array): ReadableStream<Uint8Array> {
  let offset = 0;
  return new ReadableStream<Uint8Array>(
    {
      pull(controller) {
        if (offset >= bytes.length) return controller.close();
        controller.enqueue(bytes.subarray(offset, offset + PIECE_BYTES));
        offset += PIECE_BYTES;
      },
    },
    { highWaterMark: 0 },
  );
}
