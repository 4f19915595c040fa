/** Thrown by a worker that reads one format for a file of another. Callers of loads never see it: another worker takes over. */
export class OtherFormat extends Error {
  /** Name of the file's format. */
  readonly format: string;
  /** What to read instead of a stream, of which the first bytes have been taken; null for other sources. */
  readonly stream: ReadableStream<Uint8Array> | null;

  constructor(format: string, stream: ReadableStream<Uint8Array> | null) {
    super(`The file is of the format ${format}.`);
    this.format = format;
    this.stream = stream;
  }
}
