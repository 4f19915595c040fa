import { piecePath } from '../../data/bricks/brick-files.ts';
import { SplatSourceError } from '../../data/errors.ts';
import { inLanes } from '../../data/in-lanes.ts';
import { ByteReader } from './byte-reader.ts';
import { FewRequests, MOST_REQUESTS } from './few-requests.ts';
import { KeptReads } from './kept-reads.ts';
import { shortName } from './known-source.ts';
import { addressOf, openUrl } from './open-url.ts';
import { blobRanges, type RangeSource } from './range-source.ts';
import { readAll } from './read-all.ts';
import type { ReadOptions, RequestOptions } from './splat-source.ts';

/** Cache size for pieces: the next read is often in a recent piece. */
const KEPT_BYTES = 64 << 20;
const MOST_PIECE_BYTES = KEPT_BYTES;
/** A smaller first piece is the whole file: scenes in tiny pieces would take too many requests. */
const LEAST_PIECE_BYTES = 1 << 14;

/**
 * Opens a scene that was cut into pieces, by the URL of the first. Pieces are fetched as a whole,
 * for servers without range requests. All have the size of the first, except the last, which may be
 * smaller. A first piece below 16 KiB is the whole file.
 *
 * Rejects as `openUrl`, and with SplatSourceError if a piece has another size.
 */
export async function openUrlPieces(
  url: string,
  { name = shortName(url), signal, request }: Pick<ReadOptions, 'name' | 'signal' | 'request'>,
): Promise<RangeSource> {
  const pieces = new RemotePieces(addressOf(url, name), request);
  const first = await pieces.read(0, signal);
  const pieceBytes = first.length;
  if (pieceBytes < LEAST_PIECE_BYTES) return blobRanges(new Blob([first]), name);
  return {
    name,
    totalBytes: undefined,
    read: async (offset, byteCount, partSignal) => {
      partSignal?.throwIfAborted();
      const bytes = new Uint8Array(byteCount);
      const firstIndex = Math.floor(offset / pieceBytes);
      const indices = Array.from(
        { length: Math.ceil((offset + byteCount) / pieceBytes) - firstIndex },
        (_, i) => firstIndex + i,
      );
      const parts: Uint8Array[] = [];
      await inLanes(MOST_REQUESTS, indices, async (index, stop) => {
        const ending = partSignal ? AbortSignal.any([partSignal, stop]) : stop;
        parts[index - firstIndex] = await pieces.read(index, ending);
      });
      let length = 0;
      for (const [i, piece] of parts.entries()) {
        if (piece.length > pieceBytes) throw pieces.wrongSize(indices[i], piece.length, pieceBytes);
        const start = Math.max(0, offset - indices[i] * pieceBytes);
        const part = piece.subarray(start, start + byteCount - length);
        bytes.set(part, length);
        length += part.length;
        if (piece.length < pieceBytes) break;
      }
      return bytes.subarray(0, length);
    },
  };
}

class RemotePieces {
  readonly #first: URL;
  readonly #request: RequestOptions | undefined;
  readonly #requests = new FewRequests();
  readonly #pieces = new KeptReads<Uint8Array<ArrayBuffer>>(KEPT_BYTES, ({ length }) => length);

  constructor(first: URL, request: RequestOptions | undefined) {
    this.#first = first;
    this.#request = request;
  }

  /** Reads a piece; its request is aborted when no read waits for it. */
  read(index: number, signal: AbortSignal | undefined): Promise<Uint8Array<ArrayBuffer>> {
    return this.#pieces.read(
      index,
      (ending) => this.#requests.run(() => this.#load(index, ending), ending),
      signal,
    );
  }

  wrongSize(index: number, found: number, pieceBytes: number): SplatSourceError {
    const message = `piece ${index} has ${found} bytes, more than the ${pieceBytes} of the first. Cut the scene again.`;
    return new SplatSourceError(shortName(this.#first.href), message);
  }

  async #load(index: number, signal: AbortSignal): Promise<Uint8Array<ArrayBuffer>> {
    const url = new URL(this.#first);
    url.pathname = piecePath(url.pathname, index);
    const reader = new ByteReader(
      await openUrl(url.href, { signal, ...(this.#request && { request: this.#request }) }),
      signal,
    );
    try {
      const bytes = await readAll(reader, MOST_PIECE_BYTES + 1);
      if (bytes.length <= MOST_PIECE_BYTES) return bytes;
      throw this.wrongSize(index, bytes.length, MOST_PIECE_BYTES);
    } finally {
      reader.close();
    }
  }
}
