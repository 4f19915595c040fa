/** Thrown by the PLY worker for other files; the other worker takes over, callers never see it. */
export class OtherFormat extends Error {
  /** Replaces a stream, of which the first bytes have been taken; null for other sources. */
  readonly stream: ReadableStream<Uint8Array> | null;

  constructor(stream: ReadableStream<Uint8Array> | null) {
    super('other format');
    this.stream = stream;
  }
}
