import { lockedStreamError } from './byte-reader.ts';
import { bytesOf, type KnownSource } from './known-source.ts';
import { openUrl } from './open-url.ts';
import type { OpenedSource, ReadOptions } from './splat-source.ts';

/** Piece size of streams from memory, so that reading does not block a page. */
const PIECE_BYTES = 1 << 20;

/**
 * Opens a source as a stream of bytes. Buffers are not copied. Files of a scene are opened by `openFiles`.
 *
 * Rejects with `SplatSourceError` (network, HTTP status, a locked stream), with
 * `InvalidArgumentError` if the value is no source, and with the signal's reason.
 */
export async function openSource(
  source: Exclude<KnownSource, { kind: 'files' | 'frame' }>,
  options: Pick<ReadOptions, 'signal' | 'request'> = {},
): Promise<OpenedSource> {
  options.signal?.throwIfAborted();
  const { name } = source;
  switch (source.kind) {
    case 'url':
      return openUrl(source.url, { ...options, name });
    case 'stream': {
      const { stream } = source;
      if (stream.locked) throw lockedStreamError(name);
      return { name, totalBytes: undefined, totalBytesCertain: false, isLocal: false, stream };
    }
    case 'blob':
      return openBlob(source.blob, name);
    case 'bytes': {
      const bytes = bytesOf(source.bytes);
      const local = { totalBytes: bytes.length, totalBytesCertain: true, isLocal: true };
      return { name, ...local, stream: streamOfBytes(bytes) };
    }
  }
}

export function openBlob(blob: Blob, name: string): OpenedSource {
  const reopen = () => blob.stream();
  return { name, totalBytes: blob.size, totalBytesCertain: true, isLocal: true, stream: reopen(), reopen };
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
