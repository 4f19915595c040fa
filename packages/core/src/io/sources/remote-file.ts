import { MOST_REQUEST_BYTES } from '../../data/bricks/brick-files.ts';
import { SplatSourceError } from '../../data/errors.ts';
import { ByteReader } from './byte-reader.ts';
import { bodyOf, cancelBody, isPacked, type RangeFacts, rangeOf, Transfer } from './open-url.ts';
import type { RequestOptions } from './splat-source.ts';

/** A range of bytes of a file. */
export interface ByteRange {
  readonly offset: number;
  readonly bytes: number;
}

export function endOf({ offset, bytes }: ByteRange): number {
  return offset + bytes;
}

/** HTTP statuses of a byte range, and of a range outside of the file. */
export const PARTIAL_CONTENT = 206;
const NO_SUCH_RANGE = 416;

interface FileFacts extends RangeFacts {
  /** A tag that differs only if the file has changed; equal tags prove nothing. Null if there is none. */
  readonly version: string | null;
}

/** Identifies a file on a server, to be read by any thread. Can be posted. */
export interface RemoteFacts {
  readonly name: string;
  readonly url: string;
  readonly request: Required<RequestOptions>;
  /** Facts from the first response; null for an empty file. */
  readonly facts: FileFacts | null;
}

/** A file on a server that has answered a request for a part of it. */
export class RemoteFile {
  readonly #address: URL;
  readonly #name: string;
  readonly #request: Required<RequestOptions>;
  readonly #facts: FileFacts | null;

  constructor({ name, url, request, facts }: RemoteFacts) {
    this.#address = new URL(url);
    this.#name = name;
    this.#request = request;
    this.#facts = facts;
  }

  get totalBytes(): number | undefined {
    return this.#facts ? this.#facts.totalBytes : 0;
  }

  /**
   * Reads adjacent parts by one request.
   *
   * @param give called once for each part, by its index, as soon as its bytes have arrived; they are
   *   fewer than the part has if the file ends before.
   */
  async readRun(
    parts: readonly ByteRange[],
    signal: AbortSignal | undefined,
    give: (index: number, bytes: Uint8Array<ArrayBuffer>) => void,
  ): Promise<void> {
    const start = parts[0].offset;
    const end = endOf(parts.at(-1)!);
    let given = 0;
    const giveFrom = (bytes: Uint8Array<ArrayBuffer>, isAll: boolean) => {
      for (; given < parts.length; given++) {
        const partEnd = endOf(parts[given]) - start;
        if (!isAll && partEnd > bytes.length) return;
        give(given, bytes.slice(parts[given].offset - start, partEnd));
      }
    };
    const transfer = new Transfer(this.#address, this.#name, this.#request, signal, true);
    giveFrom(await this.receive(transfer, start, end, signal, null, (bytes) => giveFrom(bytes, false)), true);
  }

  /**
   * Reads the bytes from `start` to before `end`, or to the end of the file.
   *
   * @param answer response to the first request, if already sent.
   * @param onMore called repeatedly with all bytes that have arrived.
   */
  async receive(
    transfer: Transfer,
    start: number,
    end: number,
    signal: AbortSignal | undefined,
    answer: Response | null,
    onMore?: (bytes: Uint8Array<ArrayBuffer>) => void,
  ): Promise<Uint8Array<ArrayBuffer>> {
    const { idleTimeoutMs } = this.#request;
    const expectedBytes = Math.max(0, Math.min(end, this.totalBytes ?? end) - start);
    // Grows as bytes arrive, because files and servers may promise any length.
    let bytes = new Uint8Array(Math.min(expectedBytes, MOST_REQUEST_BYTES));
    let length = 0;
    let response = answer;
    while (length < expectedBytes) {
      response ??= await askFor(transfer, start + length, expectedBytes - length);
      this.#check(response, start + length);
      if (!response) break;
      const reader = new ByteReader({ name: this.#name, stream: bodyOf(response), idleTimeoutMs }, signal);
      response = null;
      try {
        while (length < expectedBytes && (await reader.fill(1))) {
          const count = Math.min(reader.available, expectedBytes - length);
          if (length + count > bytes.length) bytes = grown(bytes, length + count, expectedBytes);
          bytes.set(reader.bytes.subarray(reader.start, reader.start + count), length);
          reader.advance(count);
          length += count;
          onMore?.(bytes.subarray(0, length));
        }
        if (length === expectedBytes || this.totalBytes === undefined) break;
        const found = `the transfer broke off after ${length} of ${expectedBytes} bytes`;
        await transfer.waitAfter(new SplatSourceError(this.#name, found));
      } catch (failure) {
        if (!(failure instanceof SplatSourceError)) throw failure;
        await transfer.waitAfter(failure);
      } finally {
        reader.close();
      }
      if (this.#facts?.validator === null) length = 0;
    }
    return bytes.subarray(0, length);
  }

  /** @throws SplatSourceError unless a response has the range from `offset` on, of the unchanged file. */
  #check(response: Response | null, offset: number): void {
    const changed = 'the file has changed on its server meanwhile. Open it again.';
    if (!response) {
      if (this.totalBytes !== undefined) throw new SplatSourceError(this.#name, changed);
      return;
    }
    const { startsAt, version, totalBytes } = factsOf(response.headers);
    const isWhole = response.status !== PARTIAL_CONTENT;
    const isOther =
      version !== this.#facts?.version ||
      (totalBytes !== undefined && this.totalBytes !== undefined && totalBytes !== this.totalBytes);
    const isWrong = isWhole || isPacked(response.headers) || (startsAt !== null && startsAt !== offset);
    if (!isOther && !isWrong) return;
    cancelBody(response);
    if (isWhole)
      throw noParts(
        this.#name,
        `the server answered ${response.status} with the whole file`,
        response.status,
      );
    if (isOther) throw new SplatSourceError(this.#name, changed);
    throw noParts(this.#name, 'the server sent another part than it was asked for, or packed it');
  }
}

export function factsOf(headers: Headers): FileFacts {
  return { ...rangeOf(headers), version: headers.get('etag') ?? headers.get('last-modified') };
}

/** Copies `bytes` into a buffer of at least `least` and at most `most` bytes. */
function grown(bytes: Uint8Array, least: number, most: number): Uint8Array<ArrayBuffer> {
  const larger = new Uint8Array(Math.max(least, Math.min(most, 2 * bytes.length)));
  larger.set(bytes);
  return larger;
}

/** Null if the file ends before `offset`. */
export async function askFor(
  transfer: Transfer,
  offset: number,
  byteCount: number,
): Promise<Response | null> {
  try {
    return await transfer.ask({ range: `bytes=${offset}-${offset + byteCount - 1}` });
  } catch (error) {
    if (error instanceof SplatSourceError && error.status === NO_SUCH_RANGE) return null;
    throw error;
  }
}

/**
 * The error for a server that does not send the parts of a file.
 *
 * @param status HTTP status of the response.
 */
export function noParts(name: string, found: string, status?: number): SplatSourceError {
  const advice =
    'Host it where range requests are answered, cut it by "websplatter split", or pass the file itself';
  return new SplatSourceError(name, `${found}, but the scene is read in parts. ${advice}.`, status);
}
