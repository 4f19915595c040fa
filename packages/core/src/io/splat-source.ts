import type { ShPrecision } from '../packing/precision.ts';

/** Anything that splats can be read from. */
export type SplatSource = string | URL | Blob | ArrayBuffer | ArrayBufferView | ReadableStream<Uint8Array>;

/** Progress of a load. */
export interface LoadProgress {
  readonly phase: 'read' | 'arrange' | 'upload';
  /** Bytes read so far. */
  readonly loadedBytes: number;
  /** Size of the source in bytes; undefined if it is not known. */
  readonly totalBytes: number | undefined;
  /** Splats decoded so far. */
  readonly splats: number;
  /** Bytes that were read per second, on average since reading began; 0 as long as that cannot be told. */
  readonly bytesPerSecond: number;
}

export interface ReadOptions {
  /** Name for messages; by default the file's name or the URL. */
  readonly name?: string;
  readonly signal?: AbortSignal;
  readonly onProgress?: (progress: LoadProgress) => void;
}

export interface ReadSplatsOptions extends ReadOptions {
  /** Precision in which to pack the spherical harmonics above degree 0; default `u8`. */
  readonly shPrecision?: ShPrecision;
}

/** A source as a stream that has not been read from. */
export interface OpenedSource {
  /** For messages: the option, the file's name or the URL. */
  readonly name: string;
  /** Size in bytes; undefined if it is not known. */
  readonly totalBytes: number | undefined;
  /**
   * Whether the stream will really give `totalBytes`. False for responses from another origin: a page sees their
   * Content-Length, which counts compressed bytes, but not their Content-Encoding. Then it is good for a progress bar
   * only.
   */
  readonly totalBytesCertain: boolean;
  readonly stream: ReadableStream<Uint8Array>;
}
