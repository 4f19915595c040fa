import { ReadableStream as WebStream } from 'node:stream/web';

/** Not `Readable.toWeb`: its stream throws an uncaught error if it is cancelled while full. */
export function webStreamOf(chunks: AsyncIterable<Uint8Array>): ReadableStream<Uint8Array<ArrayBuffer>> {
  return WebStream.from(chunks) as ReadableStream<Uint8Array<ArrayBuffer>>;
}
