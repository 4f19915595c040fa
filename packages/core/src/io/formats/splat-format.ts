import type { PackedHarmonics } from '../../packing/harmonics.ts';
import type { ShPrecision } from '../../packing/precision.ts';
import type { SplatSet } from '../../splats/splat-set.ts';
import type { ByteReader } from '../sources/byte-reader.ts';
import type { RowsTo } from './row-sink.ts';
import type { OpenedSource, ReadOptions } from '../sources/splat-source.ts';

export interface SplatFormatOptions extends Pick<ReadOptions, 'signal' | 'onProgress'> {
  /** Precision in which to pack the spherical harmonics above degree 0. */
  readonly shPrecision: ShPrecision;
  /** Files with more splats are refused. */
  readonly maxSplats: number;
}

/** A source that is being read. */
export interface SplatInput extends Omit<OpenedSource, 'stream'> {
  /** At the first byte. */
  readonly reader: ByteReader;
}

/** A file format: one object of this kind in a file of its own, and an entry in `FORMATS`. */
export interface SplatFormat {
  /** Short lower-case name. */
  readonly name: string;
  /** Whether a file that starts with these bytes (`SNIFF_BYTES` of them, or all there are) is of this format. */
  sniff(firstBytes: Uint8Array): boolean;
  /** Reads all splats; rejects with a `WebSplatterError` or the signal's reason. */
  read(input: SplatInput, options: SplatFormatOptions): Promise<SplatSet<PackedHarmonics>>;
  /** As `read`; but hands the file's rows on as they are, and returns null, if they are of the kind that `rowsTo` takes. */
  readRows?(
    input: SplatInput,
    options: SplatFormatOptions,
    rowsTo: RowsTo,
  ): Promise<SplatSet<PackedHarmonics> | null>;
}
