import { openBlob } from './open-blob.ts';
import { openUrl } from './open-url.ts';
import { bytesOf, isBlob, isStream, lockedStreamError, sourceName } from './source-kind.ts';
import type { OpenedSource, ReadOptions, SplatSource } from './splat-source.ts';

/** Piece size of streams from memory, so that reading does not block a page. */
const PIECE_BYTES = 1 << 20;

/**
 * Opens any splat source as a stream of bytes. Buffers are not copied.
 *
 * Rejects with `SplatSourceError` (network, HTTP status, a locked stream), with
 * `InvalidArgumentError` if the value is no source, and with the signal's reason.
 */
export async function openSource(source: SplatSource, options: ReadOptions = {}): Promise<OpenedSource> {
  options.signal?.throwIfAborted();
  if (typeof source === 'string' || source instanceof URL) return openUrl(String(source), options);
  const { name = sourceName(source) } = options;
  if (isStream(source)) {
    if (source.locked) throw lockedStreamError(name);
    return { name, totalBytes: undefined, totalBytesCertain: false, isHeld: false, stream: source };
  }
  if (isBlob(source)) return openBlob(source, name);
  const bytes = bytesOf(source as ArrayBuffer | ArrayBufferView);
  return {
    name,
    totalBytes: bytes.length,
    totalBytesCertain: true,
    isHeld: true,
    stream: streamOfBytes(bytes),
  };
}

export function streamOfBytes(bytes: Uint8Array): ReadableStream<Uint8Array> {
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
