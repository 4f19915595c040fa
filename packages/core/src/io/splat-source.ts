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
