import type { ReadHarmonics } from '../../data/packing/harmonics.ts';
import type { OwnShPrecision } from '../../data/packing/precision.ts';
import type { SplatSet } from '../../data/splats/splat-set.ts';
import type { DecodeMeshopt } from '../containers/meshopt.ts';
import type { ByteReader } from '../sources/byte-reader.ts';
import type { OpenedSource, ReadOptions, SceneFiles } from '../sources/splat-source.ts';
import type { Passed, RowsTo } from './row-sink.ts';

/**
 * Takes some splats of a file, in its order, with the rows that were dropped since the piece
 * before. The `bandReach` of its harmonics covers all splats so far. Its memory is used again
 * once this has resolved.
 */
export type OnPiece = (piece: SplatSet<ReadHarmonics>) => Promise<void>;

export interface SplatFormatOptions extends Pick<ReadOptions, 'signal' | 'onProgress'> {
  /** Precision in which to pack the spherical harmonics above degree 0. */
  readonly shPrecision: OwnShPrecision;
  /** Whether harmonics that are a palette stay one, and no rows are handed over; default false. */
  readonly keepsPalette?: boolean;
  /** If given, formats with successive splats call it while reading and return the last piece. */
  readonly onPiece?: OnPiece;
  /** Files with more splats are refused. */
  readonly maxSplats: number;
  /** See `ReadLimits`; undefined for the default. */
  readonly maxBytes: number | undefined;
  /** Files beside it that are fetched at once; default `MOST_REQUESTS`. */
  readonly requestsAtOnce?: number;
  /** Undefined if no file of the thread's formats needs it. */
  readonly decodeMeshopt?: DecodeMeshopt;
}

/** Number of a file's first bytes that formats are told by. */
export const SNIFF_BYTES = 4096;

/** A source that is being read. */
export interface SplatInput extends Omit<OpenedSource, 'stream'> {
  /** At the first byte. */
  readonly reader: ByteReader;
  /** Names that may tell its format; undefined if the format is known. */
  readonly fileNames?: readonly string[];
  /** The input that this one was unpacked from, if it was. */
  readonly packed?: SplatInput;
}

/** The formats that a thread reads. */
export interface FormatReaders {
  /**
   * Returns the code that reads a file; null if that is for the worker of all formats.
   *
   * @param firstBytes see `SplatFormat.recognise`.
   * @param file its name in messages.
   * @param fileNames see `SplatInput`.
   */
  pick(firstBytes: Uint8Array, file: string, fileNames: readonly string[]): ReadFormat | null;
  /** Names that the option `format` may have; undefined if the page has checked it. */
  readonly formatNames?: readonly string[];
  /** See `SplatFormatOptions`. */
  readonly decodeMeshopt?: DecodeMeshopt;
  /** For formats that have several files. */
  readonly openFiles?: (source: SceneFiles, options: ReadOptions) => OpenedSource;
}

/**
 * Reads all splats of an input. If `rowsTo` is given and takes the file, its rows go there instead, and
 * the result is `passed`.
 *
 * Rejects with a `WebSplatterError` or the signal's reason.
 */
export type ReadFormat = (
  input: SplatInput,
  options: SplatFormatOptions,
  rowsTo?: RowsTo,
) => Promise<SplatSet<ReadHarmonics> | Passed>;
