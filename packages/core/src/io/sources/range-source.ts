import { SplatSourceError, WebSplatterError } from '../../data/errors.ts';
import { messageOf } from './byte-reader.ts';
import type { RemoteFacts } from './remote-file.ts';

/** A source with random access to its bytes. */
export interface RangeSource {
  /** Source name for messages. */
  readonly name: string;
  /** Size in bytes; undefined if unknown. */
  readonly totalBytes: number | undefined;
  /**
   * Reads `byteCount` bytes from `offset` on; fewer if the source ends before.
   *
   * Rejects with SplatSourceError (network, HTTP status, a changed file), and with the signal's
   * reason.
   */
  readonly read: (
    offset: number,
    byteCount: number,
    signal?: AbortSignal,
  ) => Promise<Uint8Array<ArrayBuffer>>;
  /** Set if another thread can read the file, too; the first `heldBytes` bytes are in memory here. */
  readonly remote?: RemoteFacts & { readonly heldBytes: number };
}

export function blobRanges(blob: Blob, name: string): RangeSource {
  return {
    name,
    totalBytes: blob.size,
    read: async (offset, byteCount, signal) => {
      signal?.throwIfAborted();
      try {
        return new Uint8Array(await blob.slice(offset, offset + byteCount).arrayBuffer());
      } catch (cause) {
        if (cause instanceof WebSplatterError) throw cause;
        const message = `cannot be read: ${messageOf(cause)}. Open it again.`;
        throw new SplatSourceError(name, message, undefined, { cause });
      } finally {
        signal?.throwIfAborted();
      }
    },
  };
}
