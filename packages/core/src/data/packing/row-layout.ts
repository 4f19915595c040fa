import { CHUNK_SPLATS } from '../layout/constants.ts';
import type { Vec3 } from '../math/mat4.ts';
import type { FileFacts, ShDegree } from '../splats/splat-set.ts';

/**
 * Harmonics that the splats of a file share. Their values are handed on before the rows, which have
 * the index of an entry as a float32 in the place of their first coefficient, and no others.
 */
export interface RowPalette {
  readonly entryCount: number;
  /** Coefficients of an entry, float32 of this machine, as rows have them. */
  readonly entryValues: number;
}

/** Where the values of splats stand in the rows of a file; all are float32, except byte harmonics. */
export interface RowLayout {
  /** Number of rows. */
  readonly count: number;
  /** Bytes of a row, in all. */
  readonly strideBytes: number;
  /** Rows that are handed on at once, but for the last: whole chunks. */
  readonly pieceRows: number;
  /** Byte offset in a row of each value, by `ROW_SLOT`. */
  readonly offsets: readonly number[];
  readonly isBigEndian: boolean;
  readonly shDegree: ShDegree;
  /** Absent: harmonics are float32. */
  readonly byteHarmonics?: ByteLayout;
  /** See `DecodedRows`. */
  readonly origin?: Vec3;
  /** Undefined where each row has harmonics of its own, or none. */
  readonly palette?: RowPalette;
  /** See `SplatColumns`. */
  readonly isAntialiased?: boolean;
  /** See `SplatColumns`. */
  readonly fileFacts?: FileFacts;
}

/**
 * Harmonics that are bytes. In each piece they stand behind the other values of all rows, so that
 * bytes of a file are copied at once; their `offsets` count from the first byte of a row there.
 */
export interface ByteLayout {
  /** Bytes of a row, harmonics and others. */
  readonly strideBytes: number;
  readonly values: ByteValues;
}

/** Maps bytes to harmonic coefficients. Results must be exact in float32, fused multiply-add or not. */
export interface ByteValues {
  /** Of 0. */
  readonly least: number;
  /** Of 255. */
  readonly most: number;
  /** Others: `byte * scale + offset`. */
  readonly scale: number;
  readonly offset: number;
}

export function valueOfByte({ least, most, scale, offset }: ByteValues, byte: number): number {
  if (byte === 0) return least;
  return byte === 255 ? most : byte * scale + offset;
}

/** Values of a layout's palette; 0 without one. */
export function paletteValues({ palette }: Pick<RowLayout, 'palette'>): number {
  return palette ? palette.entryCount * palette.entryValues : 0;
}

/** Rows in as many whole chunks as fit `bytes`, at least one. */
export function rowsWithin(bytes: number, strideBytes: number): number {
  return CHUNK_SPLATS * Math.max(1, Math.floor(bytes / (strideBytes * CHUNK_SPLATS)));
}
