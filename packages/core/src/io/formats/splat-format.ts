import type { PackedHarmonics } from '../../packing/harmonics.ts';
import type { ShPrecision } from '../../packing/precision.ts';
import type { SplatSet } from '../../splats/splat-set.ts';
import type { ByteReader } from '../sources/byte-reader.ts';
import type { OpenedSource, ReadOptions } from '../sources/splat-source.ts';
import type { RowsTo } from './row-sink.ts';

/** A file format as it can be told from others, without the code that reads it. */
export interface SplatFormat {
  /** Short lower-case name, also that of the format's folder. */
  readonly name: string;
  /** What people call it. */
  readonly title: string;
  /** Ends of file names, in lower case, e.g. `.ply`; the usual one first. */
  readonly extensions: readonly string[];
  /** Of a format with several files: the name of the one that leads to the others. */
  readonly leadingFile?: RegExp;
  /**
   * Whether a file is of this format.
   *
   * @param firstBytes `SNIFF_BYTES` of them, or all there are.
   * @param fileName for formats that nothing in the bytes tells; others ignore it.
   */
  recognise(firstBytes: Uint8Array, fileName: string): boolean;
}

export interface SplatFormatOptions extends Pick<ReadOptions, 'signal' | 'onProgress'> {
  /** Precision in which to pack the spherical harmonics above degree 0. */
  readonly shPrecision: ShPrecision;
  /** Files with more splats are refused. */
  readonly maxSplats: number;
  /** Most bytes of all that is unpacked or read of other files. */
  readonly maxBytes: number;
}

/** A source that is being read. */
export interface SplatInput extends Omit<OpenedSource, 'stream'> {
  /** At the first byte. */
  readonly reader: ByteReader;
  /** The input that this one was unpacked from, if it was. */
  readonly packed?: SplatInput;
}

/**
 * Reads all splats of an input. Where `rowsTo` is given and takes such files, their rows go there instead, and the result is
 * null.
 *
 * Rejects with a `WebSplatterError` or the signal's reason.
 */
export type ReadFormat = (
  input: SplatInput,
  options: SplatFormatOptions,
  rowsTo?: RowsTo,
) => Promise<SplatSet<PackedHarmonics> | null>;
