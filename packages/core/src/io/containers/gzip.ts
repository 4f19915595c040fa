import { SplatFileError, WebSplatterError } from '../../data/errors.ts';
import type { SplatFormatOptions, SplatInput } from '../formats/splat-format.ts';
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
  const { name, reader } = packed;
  const stream = gunzip(reader.rest(), name, () => reader.byteOffset);
  return {
    name,
    totalBytes: undefined,
    totalBytesCertain: false,
    isHeld: false,
    packed,
    reader: new ByteReader({ name, stream }, signal, maxBytes),
  };
}

/**
 * The contents of a gzip stream. It fails with SplatFileError 'damaged'.
 *
 * @param byteOffset where in `file` the stream is, for that error.
 */
export function gunzip(
  packed: ReadableStream<Uint8Array<ArrayBuffer>>,
  file: string,
  byteOffset: () => number,
): ReadableStream<Uint8Array> {
  const unpacking = packed.pipeThrough(new DecompressionStream('gzip')).getReader();
  return new ReadableStream(
    {
      async pull(controller) {
        try {
          const { done, value } = await unpacking.read();
          if (done) controller.close();
          else controller.enqueue(value);
        } catch (cause) {
          // Failures before the unpacking are typed already.
          if (cause instanceof WebSplatterError) throw cause;
          const advice = 'Download or export it again';
          const message = `it cannot be unpacked (${messageOf(cause)}). ${advice}.`;
          throw new SplatFileError('damaged', file, message, { byte: byteOffset() }, { cause });
        }
      },
      cancel: (reason) => unpacking.cancel(reason),
    },
    { highWaterMark: 0 },
  );
}
