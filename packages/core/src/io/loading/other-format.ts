/** Thrown by the worker that reads PLY alone for other files. Callers of loads never see it: the other worker takes over. */
export class OtherFormat extends Error {
  /** What to read instead of a stream, of which the first bytes have been taken; null for other sources. */
  readonly stream: ReadableStream<Uint8Array> | null;

  constructor(stream: ReadableStream<Uint8Array> | null) {
    super('other format');
    this.stream = stream;
  }
}
