import type { SplatSourceError } from '../../data/errors.ts';
import type { ShPrecision } from '../../data/packing/precision.ts';
import type { SplatFormatName } from '../formats/formats.ts';

/** The files of one scene that has several, such as `meta.json` and its images. */
export interface SceneFiles {
  readonly files: readonly Blob[];
  /** Path of each, from a folder that holds all; default `webkitRelativePath`, or the name. */
  readonly paths?: readonly string[];
}

/** Source from which the same splats can be read again, any number of times. */
export type LastingSource = string | Blob | SceneFiles;

/** Anything that splats can be read from. */
export type SplatSource =
  | string
  | URL
  | Blob
  | SceneFiles
  | ArrayBuffer
  | ArrayBufferView
  | ReadableStream<Uint8Array>;

/** Progress of a load. */
export interface LoadProgress {
  readonly phase: 'read' | 'arrange' | 'upload';
  /** Bytes read so far, of all files of a scene that has several. */
  readonly loadedBytes: number;
  /** Size of the source in bytes, all files of a scene together; undefined while it is unknown. */
  readonly totalBytes: number | undefined;
  /** Splats decoded so far. */
  readonly splats: number;
  /** Bytes read per second, on average since reading began; 0 as long as that cannot be told. */
  readonly bytesPerSecond: number;
}

/** Most that is read of a source. */
export interface ReadLimits {
  /**
   * Most bytes that a source may have, unpacked where a server packs them; Infinity for no limit,
   * the default for Files, Blobs and buffers. For addresses and streams the default is 8 GiB, and
   * if a server says how much it sends no more than 64 times that (but at least 64 MiB), so that a
   * few packed bytes cannot fill the memory.
   */
  readonly maxBytes?: number;
  /** Most splats that a source may have; Infinity for no limit. Default 33,554,432. */
  readonly maxSplats?: number;
}

/** How an address is fetched. */
export interface RequestOptions {
  /** Headers of every request. Redirects are then refused: other origins could receive these. */
  readonly headers?: Readonly<Record<string, string>>;
  /** Default `same-origin`: other origins receive no cookies. */
  readonly credentials?: RequestCredentials;
  /**
   * A server that sends less than 16 KiB in this time counts as gone, ms; Infinity to wait for
   * ever. Default 30,000. Time in which nothing is read does not count.
   */
  readonly idleTimeoutMs?: number;
  /**
   * How often an overloaded server is asked again and a transfer that broke off is resumed, in all;
   * default 4. The wait before doubles from half a second on, or is as long as the server says, up
   * to 30 s.
   */
  readonly maxRetries?: number;
}

/** Options that hold for a source whenever it is read. */
export interface SourceOptions extends ReadLimits {
  /**
   * Name for messages. Its end, such as `.splat`, tells the format where the first bytes do not.
   * Default: the file's name or the URL.
   */
  readonly name?: string;
  /**
   * Format of the source where its first bytes do not tell it, as of a `.splat` whose address does
   * not end so. Default: found by names, also by those that a server's answer has.
   */
  readonly format?: SplatFormatName;
  /** For addresses. */
  readonly request?: RequestOptions;
}

/** How a source is read, an end, and reports meanwhile. */
export interface ReadOptions extends SourceOptions {
  readonly signal?: AbortSignal;
  readonly onProgress?: (progress: LoadProgress) => void;
}

export interface ReadSplatsOptions extends ReadOptions {
  /**
   * Precision in which to pack the spherical harmonics above degree 0; default `u8`. With
   * `palette`, those that are a palette in the file stay one, and others are as `f32`.
   */
  readonly shPrecision?: ShPrecision;
}

/** A source as a stream that has not been read from. */
export interface OpenedSource {
  /** For messages: the option, the file's name or the URL. */
  readonly name: string;
  /** Size in bytes; undefined if it is not known. */
  readonly totalBytes: number | undefined;
  /**
   * Whether the stream will really give `totalBytes`. False for responses from another origin: a
   * page sees their Content-Length, which counts compressed bytes, but not their Content-Encoding.
   * Then it is good for a progress bar only.
   */
  readonly totalBytesCertain: boolean;
  /** Whether `totalBytes` are there, not only promised: memory may be taken for all at once. */
  readonly isHeld: boolean;
  /** Bytes that a server says it sends, perhaps packed; undefined if it says nothing. */
  readonly sentBytes?: number;
  readonly stream: ReadableStream<Uint8Array>;
  /** Returns the stream again, from its first byte; undefined where that takes another request. */
  readonly reopen?: () => ReadableStream<Uint8Array<ArrayBuffer>>;
  /** The stream's bytes, if in memory: to be used instead of the stream, or not at all. */
  readonly unchecked?: UncheckedBytes;
  /** See `RequestOptions.idleTimeoutMs`; undefined where nothing can be late. */
  readonly idleTimeoutMs?: number;
  /** Undefined where a stream cannot be had again. */
  readonly resume?: ResumeSource;
  /** Address that answered, and how it was asked; undefined for sources that are not fetched. */
  readonly fetched?: { readonly url: string; readonly request: RequestOptions };
  /**
   * Name that opening the source has found: that of the file that leads to the others, or the one
   * that a server's Content-Disposition gives, if a page may see it.
   */
  readonly fileName?: string;
  /**
   * Opens another file of the same scene, by its path from the folder of this one; undefined where
   * there is none, and for fetched sources. Rejects with SplatFileError 'missing-part', and as
   * `openSource`.
   */
  readonly openPart?: (path: string) => Promise<OpenedSource>;
}

/** Bytes not yet known to be right. A caller that can wait for that works with them meanwhile. */
export interface UncheckedBytes {
  readonly bytes: Uint8Array<ArrayBuffer>;
  /**
   * Rejects as the stream of these bytes would, and as `pause`.
   *
   * @param pause gives others a turn.
   */
  check(pause: () => Promise<void>): Promise<void>;
}

/**
 * Opens the source again after a stream of it has failed, to go on at byte `offset`.
 *
 * Rejects with `failure`, with a SplatSourceError for the lost rest, or with the signal's reason.
 */
export type ResumeSource = (offset: number, failure: SplatSourceError) => Promise<ResumedStream>;

export interface ResumedStream {
  readonly stream: ReadableStream<Uint8Array>;
  /** Where in the source the stream begins: at the offset asked for, or before. */
  readonly startsAt: number;
}
