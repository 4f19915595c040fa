import { SplatFileError, WebSplatterError } from '../../data/errors.ts';
import type { SplatFormatOptions, SplatInput } from '../formats/read-format.ts';
import { ByteReader, messageOf } from '../sources/byte-reader.ts';
import { unpackedLimit } from '../sources/read-limits.ts';

/** Reads the contents of a gzip stream (RFC 1952) by `read`. */
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
 * @param maxBytes most that it may have.
 */
function unpackGzip(packed: SplatInput, signal: AbortSignal | undefined, maxBytes: number): SplatInput {
  const { name, reader, reopen } = packed;
  const stream = gunzip(reader.rest(), name, () => reader.byteOffset);
  return {
    name,
    totalBytes: undefined,
    totalBytesCertain: false,
    isHeld: false,
    packed,
    fileNames: packed.fileNames?.map((each) => each.replace(/\.gz$/i, '')),
    reader: new ByteReader({ name, stream }, signal, maxBytes),
    reopen: reopen && (() => gunzip(reopen(), name, () => reader.byteOffset)),
  };
}

/** Packed bytes that are unpacked before it is looked whether more is wanted. */
const PACKED_AT_ONCE = 1 << 16;

/**
 * The contents of a gzip stream, or of another kind of deflated stream. It fails with
 * SplatFileError 'damaged'.
 *
 * @param byteOffset where in `file` the stream is, for that error.
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
          // Failures before the unpacking are typed already.
          if (cause instanceof WebSplatterError) throw cause;
          const advice = 'Download or export it again';
          const message = `it cannot be unpacked (${messageOf(cause)}). ${advice}.`;
          throw new SplatFileError('damaged', file, message, { byte: byteOffset() }, { cause });
        } finally {
          demand.end();
        }
      },
      // Not `unpacked`: Node 20's, cancelled while it works, can throw where nothing catches it.
      cancel: (reason) => source.cancel(reason),
    },
    { highWaterMark: 0 },
  );
}

/**
 * Unpacks bytes while there is a demand, a few at a time. A pipe would not do: Node's
 * DecompressionStream takes all bytes at once, whether or not anything reads what they give.
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
    // The reader of the results has what failed: this rejects where unpacking did.
    await target.abort(cause).catch(() => {});
  }
}

/** Whether something is waited for. */
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

  /** Resolves once there is a demand. */
  async wait(): Promise<void> {
    if (!this.#isThere) await new Promise<void>((resolve) => (this.#onBegin = resolve));
  }
}
