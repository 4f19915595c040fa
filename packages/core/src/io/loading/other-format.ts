/** Thrown by a worker that reads one format for a file of another. Callers of loads never see it: another worker takes over. */
export class OtherFormat extends Error {
  /** By which the format is told: `SNIFF_BYTES`, or all there are. */
  readonly firstBytes: Uint8Array;
  /** What to read instead of a stream, of which the first bytes have been taken; null for other sources. */
  readonly stream: ReadableStream<Uint8Array> | null;

  constructor(firstBytes: Uint8Array, stream: ReadableStream<Uint8Array> | null) {
    super('other format');
    this.firstBytes = firstBytes;
    this.stream = stream;
  }
}
