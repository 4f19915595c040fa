/** Bytes between two chances to stop. */
const PIECE_BYTES = 1 << 18;

export interface PackOptions {
  readonly signal?: AbortSignal;
  /** Told how much is packed, from 0 to 1. */
  readonly onProgress?: (fraction: number) => void;
}

/** Packs bytes as a gzip stream (RFC 1952). Rejects with the signal's reason once it aborts. */
export async function packGzip(
  bytes: Uint8Array<ArrayBuffer>,
  { signal, onProgress }: PackOptions,
): Promise<Uint8Array<ArrayBuffer>> {
  const { readable, writable } = new CompressionStream('gzip');
  const packed = new Response(readable).arrayBuffer();
  const writer = writable.getWriter();
  try {
    for (let at = 0; at < bytes.length; at += PIECE_BYTES) {
      signal?.throwIfAborted();
      await writer.write(bytes.subarray(at, at + PIECE_BYTES));
      onProgress?.(Math.min(1, (at + PIECE_BYTES) / bytes.length));
    }
    signal?.throwIfAborted();
    await writer.close();
  } catch (error) {
    packed.catch(() => {});
    await writer.abort(error).catch(() => {});
    throw error;
  }
  return new Uint8Array(await packed);
}
