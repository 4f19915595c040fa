import type { ReadHarmonics } from '../../data/packing/harmonics.ts';
import type { OwnShPrecision } from '../../data/packing/precision.ts';
import type { SplatSet } from '../../data/splats/splat-set.ts';
import type { DecodeMeshopt } from '../containers/meshopt.ts';
import type { ByteReader } from '../sources/byte-reader.ts';
import type { OpenedSource, ReadOptions, SceneFiles } from '../sources/splat-source.ts';
import type { Passed, RowsTo } from './rows/row-sink.ts';

/**
 * Receives a piece of a file's splats, in file order, with the number of rows dropped before it.
 * The `bandReach` of its harmonics covers all splats so far. The memory of the piece is reused once
 * the promise has resolved.
 */
export type OnPiece = (piece: SplatSet<ReadHarmonics>) => Promise<void>;

export interface SplatFormatOptions extends Pick<ReadOptions, 'signal' | 'onProgress'> {
  /** Precision in which to pack spherical harmonics above degree 0. */
  readonly shPrecision: OwnShPrecision;
  /** Whether palettes are preserved and no rows go to a sink. Default: false. */
  readonly keepsPalette?: boolean;
  /** If present, formats with sequential splats call it while reading, and return the last piece. */
  readonly onPiece?: OnPiece;
  /** Files with more splats are refused. */
  readonly maxSplats: number;
  /** See `ReadLimits`; undefined for the default. */
  readonly maxBytes: number | undefined;
  /** Undefined if no format of this thread uses meshopt. */
  readonly decodeMeshopt?: DecodeMeshopt;
}

/** Number of first bytes by which formats are detected. */
export const SNIFF_BYTES = 4096;

/** An opened source. */
export interface SplatInput extends Omit<OpenedSource, 'stream'> {
  /** Positioned at the first byte. */
  readonly reader: ByteReader;
  /** Names from which the format may be detected; undefined if the format is known. */
  readonly fileNames?: readonly string[];
  /** The archive or gzip input that contains this one; undefined if there is none. */
  readonly packed?: SplatInput;
  /** What the files beside it say about a PLY; see `FileFacts`. */
  readonly note?: string;
}

/** The readers of a thread. */
export interface FormatReaders {
  /**
   * Returns the reader of a file; null if only the worker for all formats has it.
   *
   * @param firstBytes see `SplatFormat.recognise`.
   * @param file its name in messages.
   * @param fileNames see `SplatInput`.
   */
  pick(firstBytes: Uint8Array, file: string, fileNames: readonly string[]): ReadFormat | null;
  /** Throws InvalidArgumentError if there is no such format; undefined if the page has chosen the worker by it. */
  readonly checkFormat?: (format: string | undefined) => void;
  /** See `SplatFormatOptions`. */
  readonly decodeMeshopt?: DecodeMeshopt;
  /** For formats with several files. */
  readonly openFiles?: (source: Required<SceneFiles>, options: Pick<ReadOptions, 'name'>) => OpenedSource;
}

/**
 * Reads all splats of an input. If `rowsTo` is present and accepts the file, the rows go there, and
 * the result is `passed`.
 *
 * Rejects with a `WebSplatterError` or the signal's reason.
 */
export type ReadFormat = (
  input: SplatInput,
  options: SplatFormatOptions,
  rowsTo?: RowsTo,
) => Promise<SplatSet<ReadHarmonics> | Passed>;
