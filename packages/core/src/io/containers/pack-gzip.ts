/** Bytes between two checks of the abort signal. */
const PIECE_BYTES = 1 << 18;

export interface PackGzipOptions {
  readonly signal?: AbortSignal;
  /** Called with the packed fraction, from 0 to 1. */
  readonly onProgress?: (fraction: number) => void;
}

type Put = (bytes: Uint8Array<ArrayBuffer>) => Promise<void>;

/** Packs bytes as a gzip stream (RFC 1952). Rejects with the signal's reason once it aborts. */
export async function packGzip(
  bytes: Uint8Array<ArrayBuffer>,
  { signal, onProgress }: PackGzipOptions,
): Promise<Uint8Array<ArrayBuffer>> {
  return collected('gzip', async (put) => {
    for (let at = 0; at < bytes.length; at += PIECE_BYTES) {
      signal?.throwIfAborted();
      await put(bytes.subarray(at, at + PIECE_BYTES));
      onProgress?.(Math.min(1, (at + PIECE_BYTES) / bytes.length));
    }
    signal?.throwIfAborted();
  });
}

/** Packs bytes as a zlib stream (RFC 1950), which ends with a checksum. */
export function packZlib(bytes: Uint8Array<ArrayBuffer>): Promise<Uint8Array<ArrayBuffer>> {
  return collected('deflate', (put) => put(bytes));
}

async function collected(
  format: CompressionFormat,
  work: (put: Put) => Promise<void>,
): Promise<Uint8Array<ArrayBuffer>> {
  const parts: Uint8Array<ArrayBuffer>[] = [];
  const keep = async (part: Uint8Array<ArrayBuffer>) => {
    parts.push(part);
  };
  await packTo(format, keep, work);
  return new Uint8Array(await new Blob(parts).arrayBuffer());
}

/**
 * Packs the output of `work` as a gzip stream, and passes packed bytes to `put` as they are ready.
 * The bytes that `work` outputs must not change afterwards.
 *
 * Rejects as `put` and `work` do.
 */
export async function packGzipTo(put: Put, work: (put: Put) => Promise<void>): Promise<void> {
  await packTo('gzip', put, work);
}

async function packTo(format: CompressionFormat, put: Put, work: (put: Put) => Promise<void>): Promise<void> {
  const { readable, writable } = new CompressionStream(format);
  const writer = writable.getWriter();
  const packing = readable.pipeTo(new WritableStream({ write: put }));
  try {
    // A failure of `put` is the root cause, so it wins over the write error that follows from it.
    await work((bytes) => Promise.race([writer.write(bytes), packing]));
    await Promise.race([writer.close(), packing]);
  } catch (error) {
    // Thrown next is the error that came first.
    packing.catch(() => {});
    await writer.abort(error).catch(() => {});
    throw error;
  }
  await packing;
}
