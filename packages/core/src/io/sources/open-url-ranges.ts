import { MOST_REQUEST_BYTES } from '../../data/bricks/brick-files.ts';
import { SplatSourceError } from '../../data/errors.ts';
import { onAbort } from '../../data/on-abort.ts';
import { ByteReader } from './byte-reader.ts';
import { checkRequest } from './check-request.ts';
import { FewRequests } from './few-requests.ts';
import { addressOf, bodyOf, cancelBody, isPacked, type PartFacts, partOf, Transfer } from './open-url.ts';
import { blobRanges, type RangeSource } from './range-source.ts';
import { readAll } from './read-all.ts';
import { shortName } from './source-kind.ts';
import type { ReadOptions, RequestOptions } from './splat-source.ts';

/** HTTP statuses of a byte range, and of a range outside of the file. */
const PARTIAL_CONTENT = 206;
const NO_SUCH_RANGE = 416;
/** Largest file to keep in memory if a server ignores range requests. */
const MOST_WHOLE_BYTES = 64 << 20;

/**
 * Opens a URL for reads of byte ranges. Adjacent ranges that are requested in the same turn become
 * one request; each resolves once its own bytes have arrived. A broken or stalled request is
 * resumed, if the server can prove that the file is unchanged. Pages may be unable to read
 * Content-Range of another origin; the length is checked then.
 *
 * Rejects as `openUrl`, and with SplatSourceError if a server ignores ranges of a large file.
 *
 * @param firstBytes size of the first request, whose response has the file size.
 * @param requests request queue of the scene.
 */
export async function openUrlRanges(
  url: string,
  firstBytes: number,
  { name = shortName(url), signal, request = {} }: Pick<ReadOptions, 'name' | 'signal' | 'request'>,
  requests = new FewRequests(),
): Promise<RangeSource> {
  const checked = checkRequest(request);
  const address = addressOf(url, name);
  const transfer = new Transfer(address, name, checked, signal);
  if (!transfer.isRemote) return blobRanges(await (await transfer.ask({})).blob(), name);
  const answer = await askFor(transfer, 0, firstBytes);
  if (answer && answer.status !== PARTIAL_CONTENT)
    return blobRanges(new Blob([await readSmall(transfer, answer, name, signal)]), name);
  const file = new RemoteFile(address, name, checked, requests, answer && factsOf(answer.headers));
  const first = await file.receive(transfer, 0, firstBytes, signal, answer);
  return {
    name,
    totalBytes: file.totalBytes,
    read: async (offset, byteCount, partSignal) => {
      partSignal?.throwIfAborted();
      const held = first.subarray(offset, offset + byteCount);
      if (held.length === byteCount) return held;
      const rest = await file.read(offset + held.length, byteCount - held.length, partSignal);
      if (held.length === 0) return rest;
      const bytes = new Uint8Array(held.length + rest.length);
      bytes.set(held);
      bytes.set(rest, held.length);
      return bytes;
    },
  };
}

/** A pending read. */
interface AskedPart {
  readonly offset: number;
  readonly byteCount: number;
  readonly signal: AbortSignal | undefined;
  readonly resolve: (bytes: Uint8Array<ArrayBuffer>) => void;
  readonly reject: (reason: unknown) => void;
}

interface FileFacts extends PartFacts {
  /** A tag that differs only if the file has changed; equal tags prove nothing. Null if there is none. */
  readonly version: string | null;
}

class RemoteFile {
  readonly #address: URL;
  readonly #name: string;
  readonly #request: Required<RequestOptions>;
  readonly #requests: FewRequests;
  readonly #facts: FileFacts | null;
  /** Reads of the current turn, not yet requested. */
  #asked: AskedPart[] = [];

  /** @param facts facts from the first response; null for an empty file. */
  constructor(
    address: URL,
    name: string,
    request: Required<RequestOptions>,
    requests: FewRequests,
    facts: FileFacts | null,
  ) {
    this.#address = address;
    this.#name = name;
    this.#request = request;
    this.#requests = requests;
    this.#facts = facts;
  }

  get totalBytes(): number | undefined {
    return this.#facts ? this.#facts.totalBytes : 0;
  }

  read(offset: number, byteCount: number, signal?: AbortSignal): Promise<Uint8Array<ArrayBuffer>> {
    return new Promise((resolve, reject) => {
      if (this.#asked.length === 0) queueMicrotask(() => this.#send());
      this.#asked.push({ offset, byteCount, signal, resolve, reject });
    });
  }

  /** Sends one request for each run of adjacent reads. */
  #send(): void {
    const asked = this.#asked.sort((a, b) => a.offset - b.offset);
    this.#asked = [];
    let run: AskedPart[] = [];
    for (const [i, part] of asked.entries()) {
      run.push(part);
      const next = asked[i + 1];
      const isAdjacent = next?.offset === endOf(part);
      if (isAdjacent && endOf(next) - run[0].offset <= MOST_REQUEST_BYTES) continue;
      void this.#readRun(run);
      run = [];
    }
  }

  /** Reads adjacent ranges by one request, which is aborted once all of them were aborted. */
  async #readRun(run: readonly AskedPart[]): Promise<void> {
    const ending = new AbortController();
    const waiting = new Set(run);
    const ignoreSignals = run.map((part) => {
      const { signal, reject } = part;
      const leave = () => {
        reject(signal!.reason);
        waiting.delete(part);
        if (waiting.size === 0) ending.abort(signal!.reason);
      };
      if (signal?.aborted) leave();
      return onAbort(signal, leave);
    });
    const start = run[0].offset;
    const give = (bytes: Uint8Array<ArrayBuffer>, isAll: boolean) => {
      for (const part of waiting) {
        if (!isAll && endOf(part) > start + bytes.length) return;
        waiting.delete(part);
        part.resolve(bytes.slice(part.offset - start, endOf(part) - start));
      }
    };
    try {
      const { signal } = ending;
      const transfer = new Transfer(this.#address, this.#name, this.#request, signal, true);
      const end = endOf(run.at(-1)!);
      const receive = () => this.receive(transfer, start, end, signal, null, (bytes) => give(bytes, false));
      give(await this.#requests.run(receive, signal), true);
    } catch (error) {
      for (const { reject } of waiting) reject(error);
    } finally {
      for (const ignore of ignoreSignals) ignore();
    }
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

function factsOf(headers: Headers): FileFacts {
  return { ...partOf(headers), version: headers.get('etag') ?? headers.get('last-modified') };
}

/** Copies `bytes` into a buffer of at least `least` and at most `most` bytes. */
function grown(bytes: Uint8Array, least: number, most: number): Uint8Array<ArrayBuffer> {
  const larger = new Uint8Array(Math.max(least, Math.min(most, 2 * bytes.length)));
  larger.set(bytes);
  return larger;
}

function endOf({ offset, byteCount }: AskedPart): number {
  return offset + byteCount;
}

/** Null if the file ends before `offset`. */
async function askFor(transfer: Transfer, offset: number, byteCount: number): Promise<Response | null> {
  try {
    return await transfer.ask({ range: `bytes=${offset}-${offset + byteCount - 1}` });
  } catch (error) {
    if (error instanceof SplatSourceError && error.status === NO_SUCH_RANGE) return null;
    throw error;
  }
}

/** Reads a response that has the whole file. */
async function readSmall(
  transfer: Transfer,
  answer: Response,
  name: string,
  signal: AbortSignal | undefined,
): Promise<Uint8Array<ArrayBuffer>> {
  const opened = transfer.openAnswer(answer);
  const reader = new ByteReader(opened, signal);
  try {
    const isLarge = opened.totalBytesCertain && (opened.totalBytes ?? 0) > MOST_WHOLE_BYTES;
    const bytes = isLarge ? null : await readAll(reader, MOST_WHOLE_BYTES + 1);
    if (bytes && bytes.length <= MOST_WHOLE_BYTES) return bytes;
    throw noParts(
      name,
      `the server answered ${answer.status} with the whole file, of more than 64 MiB`,
      answer.status,
    );
  } finally {
    reader.close();
  }
}

/** @param status HTTP status of the response. */
function noParts(name: string, found: string, status?: number): SplatSourceError {
  const advice =
    'Host it where range requests are answered, cut it by "websplatter split", or pass the file itself';
  return new SplatSourceError(name, `${found}, but the scene is read in parts. ${advice}.`, status);
}
