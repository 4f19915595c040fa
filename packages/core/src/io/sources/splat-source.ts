import type { SplatSourceError } from '../../data/errors.ts';
import type { PackedHarmonics } from '../../data/packing/harmonics.ts';
import type { PackedCloud } from '../../data/packing/packed-cloud.ts';
import type { CloudPrecision, OwnShPrecision, ShPrecision } from '../../data/packing/precision.ts';
import type { SplatSet } from '../../data/splats/splat-set.ts';
import type { SplatFormatName } from '../formats/formats.ts';

/** The files of a scene with several files, such as `meta.json` and its images. */
export interface SceneFiles {
  readonly files: readonly Blob[];
  /** Path of each file, relative to a common folder. Default: `webkitRelativePath`, or the name. */
  readonly paths?: readonly string[];
}

/**
 * A frame of a file that `openFrames` has opened: a source like a file of its own, which can be read until
 * the opened file ends.
 */
export interface SplatFrame {
  /** Name for messages: of the file, with the number of the frame. */
  readonly name: string;
  /** @internal Fetches, decodes and packs the frame. */
  readonly loadFrame: (precision: CloudPrecision, signal?: AbortSignal) => Promise<PackedCloud>;
  /** @internal Fetches and decodes the frame. */
  readonly readFrame: (
    shPrecision: OwnShPrecision,
    signal?: AbortSignal,
  ) => Promise<SplatSet<PackedHarmonics>>;
}

/** A source that can be read repeatedly. */
export type LastingSource = string | Blob | SceneFiles | SplatFrame;

/** Anything that splats can be read from. */
export type SplatSource =
  | string
  | URL
  | Blob
  | SceneFiles
  | SplatFrame
  | ArrayBuffer
  | ArrayBufferView
  | ReadableStream<Uint8Array>;

/** Progress of a load. */
export interface LoadProgress {
  readonly phase: 'read' | 'arrange' | 'upload';
  /** Bytes read so far, summed over all files of the scene. */
  readonly loadedBytes: number;
  /** Size in bytes, summed over all files of the scene; undefined while unknown. */
  readonly totalBytes: number | undefined;
  /** Number of splats decoded so far. */
  readonly splats: number;
  /** Average bytes per second since reading began; 0 while unknown. */
  readonly bytesPerSecond: number;
}

/** Limits of the bytes and splats of a source. */
export interface ReadLimits {
  /**
   * Most bytes of a source, unpacked if a server compresses them; Infinity for no limit. Default:
   * no limit for Files, Blobs and buffers; 8 GiB for URLs and streams. For URLs, the unpacked size
   * is also limited to 64 times the size that the server states, or 64 MiB if that is more. This
   * bound stops decompression bombs.
   */
  readonly maxBytes?: number;
  /** Most splats of a source; Infinity for no limit. Default: 33,554,432. */
  readonly maxSplats?: number;
}

/** Options of HTTP requests. */
export interface RequestOptions {
  /** Headers of every request. Redirects are then refused, because other origins could receive these. */
  readonly headers?: Readonly<Record<string, string>>;
  /** Default: `same-origin`; other origins receive no cookies. */
  readonly credentials?: RequestCredentials;
  /**
   * Stall timeout in milliseconds: a server that sends less than 16 KiB in this time counts as
   * gone. Infinity disables it. Default: 30,000. Time in which nothing is read does not count.
   */
  readonly idleTimeoutMs?: number;
  /**
   * Most retries per file, for overloaded servers and broken transfers together. Default: 4. The
   * wait before each doubles from half a second on, and is at least the server's Retry-After. A
   * Retry-After above 30 s is an error.
   */
  readonly maxRetries?: number;
}

/** Options of a source, independent of the kind of read. */
export interface SourceOptions extends ReadLimits {
  /**
   * Name for messages. Its extension, such as `.splat`, determines the format if the first bytes do
   * not. Default: the file's name or the URL.
   */
  readonly name?: string;
  /**
   * Format of the source, if its first bytes do not determine it: for example a `.splat` whose URL
   * has another extension. Default: detected by names, including a name in the server's response.
   */
  readonly format?: SplatFormatName;
  /** For URLs. */
  readonly request?: RequestOptions;
}

/** Options, abort signal and progress callback of a read. */
export interface ReadOptions extends SourceOptions {
  readonly signal?: AbortSignal;
  readonly onProgress?: (progress: LoadProgress) => void;
}

export interface ReadSplatsOptions extends ReadOptions {
  /**
   * Precision in which to pack spherical harmonics above degree 0. Default: `u8`. `palette`
   * preserves a palette of the file, and stores other harmonics as `f32`.
   */
  readonly shPrecision?: ShPrecision;
}

/** An opened source, as an unread stream. */
export interface OpenedSource {
  /** Name for messages: the option, the file's name or the URL. */
  readonly name: string;
  /** Size in bytes; undefined if unknown. */
  readonly totalBytes: number | undefined;
  /**
   * Whether the stream will have exactly `totalBytes`. False for responses from another origin.
   * Their Content-Length counts compressed bytes, and a page cannot read their Content-Encoding.
   * The size is then good for a progress bar only.
   */
  readonly totalBytesCertain: boolean;
  /** Whether nothing is waited for (bytes, File, Blob), so that memory for all is allocated at once. */
  readonly isLocal: boolean;
  /** Content-Length of the response, perhaps of compressed bytes; undefined if not stated. */
  readonly sentBytes?: number;
  readonly stream: ReadableStream<Uint8Array>;
  /** Returns the stream again, from its first byte; undefined if that takes another request. */
  readonly reopen?: () => ReadableStream<Uint8Array<ArrayBuffer>>;
  /** The stream's bytes, if in memory. Use either them or the stream. */
  readonly unchecked?: UncheckedBytes;
  /** See `RequestOptions.idleTimeoutMs`; undefined if the source cannot stall. */
  readonly idleTimeoutMs?: number;
  /** Undefined if a stream cannot be reopened. */
  readonly resume?: ResumeSource;
  /** Final URL and request options; undefined for sources that are not fetched. */
  readonly fetched?: { readonly url: string; readonly request: RequestOptions };
  /**
   * File name found while opening: the name of the scene's leading file, or the name in a readable
   * Content-Disposition.
   */
  readonly fileName?: string;
  /**
   * Opens another file of the same scene, by its path relative to this file's folder. Undefined for
   * single files, and for fetched sources. Rejects with SplatFileError 'missing-part', and as
   * `openSource`.
   */
  readonly openPart?: (path: string) => Promise<OpenedSource>;
}

/** Bytes whose checksum is not yet verified. A caller can process them in the meantime. */
export interface UncheckedBytes {
  readonly bytes: Uint8Array<ArrayBuffer>;
  /**
   * Verifies the checksum. Rejects as the stream of these bytes would, and as `pause`.
   *
   * @param pause yields to the event loop.
   */
  check(pause: () => Promise<void>): Promise<void>;
}

/**
 * Reopens the source after a stream of it has failed, to resume at byte `offset`.
 *
 * Rejects with `failure`, with a SplatSourceError for the lost rest, or with the signal's reason.
 */
export type ResumeSource = (offset: number, failure: SplatSourceError) => Promise<ResumedStream>;

export interface ResumedStream {
  readonly stream: ReadableStream<Uint8Array>;
  /** Offset of the stream's first byte in the source: at most the requested offset. */
  readonly startsAt: number;
}
