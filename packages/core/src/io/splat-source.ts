import type { ShPrecision } from '../packing/precision.ts';

/** Anything that splats can be read from. */
export type SplatSource = string | URL | Blob | ArrayBuffer | ArrayBufferView | ReadableStream<Uint8Array>;

/** How far a load has come. */
export interface LoadProgress {
  readonly phase: 'read' | 'arrange' | 'upload';
  /** Bytes read so far. */
  readonly loadedBytes: number;
  /** Size of the source in bytes, undefined where it is not known. */
  readonly totalBytes: number | undefined;
  /** Splats decoded so far. */
  readonly splats: number;
}

export interface ReadOptions {
  /** Name for messages; by default the file's name or the URL. */
  readonly name?: string;
  readonly signal?: AbortSignal;
  readonly onProgress?: (progress: LoadProgress) => void;
}

export interface ReadSplatsOptions extends ReadOptions {
  /** Precision to store the spherical harmonics above degree 0 in; default `u8`. */
  readonly shPrecision?: ShPrecision;
}

/** A source as a stream that has not been read from. */
export interface OpenedSource {
  /** For messages: the option, the file's name or the URL. */
  readonly name: string;
  /** Size in bytes, undefined where it is not known. */
  readonly totalBytes: number | undefined;
  /**
   * Whether `totalBytes` is what the stream will really give. False for answers from another origin: a page sees their
   * Content-Length, which is that of the compressed bytes, but not their Content-Encoding. Good for a progress bar only.
   */
  readonly totalBytesCertain: boolean;
  readonly stream: ReadableStream<Uint8Array>;
}
