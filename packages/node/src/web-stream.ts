import { ReadableStream as WebStream } from 'node:stream/web';

/** `Readable.toWeb` gives a stream that throws outside of every promise if cancelled while full. */
export function webStreamOf(chunks: AsyncIterable<Uint8Array>): ReadableStream<Uint8Array<ArrayBuffer>> {
  return WebStream.from(chunks) as ReadableStream<Uint8Array<ArrayBuffer>>;
}
