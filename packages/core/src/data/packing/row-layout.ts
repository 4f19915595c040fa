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
  readonly strideBytes: number;
  /** Rows that are handed on at once, but for the last: whole chunks. */
  readonly pieceRows: number;
  /** Byte offset in a row of each value, by `ROW_SLOT`. */
  readonly offsets: readonly number[];
  readonly isBigEndian: boolean;
  readonly shDegree: ShDegree;
  /** Whether harmonics are bytes by `shOfByte`, anywhere in a row. Default: false, they are float32. */
  readonly hasByteHarmonics?: boolean;
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
 * Harmonic coefficient of a byte. Writers divide −4 … 4 into 256 steps and store the step's index;
 * its midpoint has the least average error. Values out of range are clamped to the outermost steps,
 * which stand for −4 and 4. All results are exact in float32.
 */
export function shOfByte(byte: number): number {
  if (byte === 0) return -4;
  return byte === 255 ? 4 : (byte + 0.5) / 32 - 4;
}

/** Values of a layout's palette; 0 without one. */
export function paletteValues({ palette }: Pick<RowLayout, 'palette'>): number {
  return palette ? palette.entryCount * palette.entryValues : 0;
}

/** Rows in as many whole chunks as fit `bytes`, at least one. */
export function rowsWithin(bytes: number, strideBytes: number): number {
  return CHUNK_SPLATS * Math.max(1, Math.floor(bytes / (strideBytes * CHUNK_SPLATS)));
}
