import { SplatFileError, WebSplatterError } from '../../data/errors.ts';
import type { SplatFormatOptions, SplatInput } from '../formats/read-format.ts';
import { ByteReader, messageOf } from '../sources/byte-reader.ts';
import { streamOfBytes } from '../sources/open-source.ts';
import { unpackedLimit } from '../sources/read-limits.ts';

/** Unpacks a gzip stream (RFC 1952) and passes its contents to `read`. */
export async function readGzipped<Result>(
  packed: SplatInput,
  options: Pick<SplatFormatOptions, 'signal' | 'maxBytes'>,
  read: (input: SplatInput) => Promise<Result>,
): Promise<Result> {
  const input = unpackGzip(packed, options.signal, unpackedLimit(options, packed));
  try {
    return await read(input);
  } finally {
    input.reader.close();
  }
}

/**
 * The contents of a gzip stream, as an input of its own.
 *
 * @param maxBytes most unpacked bytes.
 */
function unpackGzip(packed: SplatInput, signal: AbortSignal | undefined, maxBytes: number): SplatInput {
  const { name, reader, reopen } = packed;
  const stream = gunzip(reader.rest(), name, () => reader.byteOffset);
  return {
    name,
    totalBytes: undefined,
    totalBytesCertain: false,
    isLocal: false,
    packed,
    fileNames: packed.fileNames?.map((each) => each.replace(/\.gz$/i, '')),
    reader: new ByteReader({ name, stream }, signal, maxBytes),
    reopen: reopen && (() => gunzip(reopen(), name, () => reader.byteOffset)),
  };
}

/** Packed bytes between two checks for demand. */
const PACKED_AT_ONCE = 1 << 16;

/**
 * Unpacks a gzip stream, or another kind of deflated stream. The result fails with SplatFileError
 * 'damaged'.
 *
 * @param byteOffset offset of the stream in `file`, for the error.
 */
export function gunzip(
  packed: ReadableStream<Uint8Array<ArrayBuffer>>,
  file: string,
  byteOffset: () => number,
  format: CompressionFormat = 'gzip',
): ReadableStream<Uint8Array<ArrayBuffer>> {
  const { readable, writable } = new DecompressionStream(format);
  const unpacked = readable.getReader();
  const source = packed.getReader();
  const demand = new Demand();
  feed(source, writable.getWriter(), demand);
  return new ReadableStream(
    {
      async pull(controller) {
        demand.begin();
        try {
          const { done, value } = await unpacked.read();
          if (done) controller.close();
          else controller.enqueue(value);
        } catch (cause) {
          // Errors of the source are typed already.
          if (cause instanceof WebSplatterError) throw cause;
          const advice = 'Download or export it again';
          const message = `it cannot be unpacked (${messageOf(cause)}). ${advice}.`;
          throw new SplatFileError('damaged', file, message, { byte: byteOffset() }, { cause });
        } finally {
          demand.end();
        }
      },
      // The source is cancelled, not `unpacked`: in Node 20, cancelling an active `unpacked` can
      // throw an uncaught error.
      cancel: (reason) => source.cancel(reason),
    },
    { highWaterMark: 0 },
  );
}

/**
 * Unpacks a zlib stream. Rejects with SplatFileError 'damaged', also if it unpacks to more than
 * `mostBytes`.
 */
export async function unpackZlib(
  packed: Uint8Array<ArrayBuffer>,
  mostBytes: number,
  what: string,
  byte: number,
): Promise<Uint8Array<ArrayBuffer>> {
  const stream = streamOfBytes(packed) as ReadableStream<Uint8Array<ArrayBuffer>>;
  const reader = gunzip(stream, what, () => byte, 'deflate').getReader();
  const unpacked = new Uint8Array(mostBytes);
  let length = 0;
  for (;;) {
    const { done, value } = await reader.read();
    if (done) return unpacked.subarray(0, length);
    if (length + value.length > mostBytes) {
      // The error thrown next says why reading ends.
      reader.cancel().catch(() => {});
      const message = `it unpacks to more than ${mostBytes} bytes. Download or export it again.`;
      throw new SplatFileError('damaged', what, message, { byte });
    }
    unpacked.set(value, length);
    length += value.length;
  }
}

/**
 * Feeds packed bytes on demand, a few at a time. `pipeThrough` has no backpressure here: Node's
 * DecompressionStream accepts all bytes at once, even if nothing reads its output.
 */
async function feed(
  source: ReadableStreamDefaultReader<Uint8Array<ArrayBuffer>>,
  target: WritableStreamDefaultWriter<Uint8Array<ArrayBuffer>>,
  demand: Demand,
): Promise<void> {
  try {
    for (;;) {
      await demand.wait();
      const { done, value } = await source.read();
      if (done) return await target.close();
      for (let at = 0; at < value.length; at += PACKED_AT_ONCE) {
        await demand.wait();
        await target.write(value.subarray(at, at + PACKED_AT_ONCE));
      }
    }
  } catch (cause) {
    // The reader of the output already gets this error: `abort` rejects with it as well.
    await target.abort(cause).catch(() => {});
  }
}

/** Signals that the consumer waits for data. */
class Demand {
  #isThere = false;
  #onBegin = () => {};

  begin(): void {
    this.#isThere = true;
    this.#onBegin();
  }

  end(): void {
    this.#isThere = false;
  }

  async wait(): Promise<void> {
    if (!this.#isThere) await new Promise<void>((resolve) => (this.#onBegin = resolve));
  }
}
