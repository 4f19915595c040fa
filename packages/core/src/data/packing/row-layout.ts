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

/** Where the values of splats stand in the rows of a file; all of them are float32. */
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
  /** See `DecodedRows`. */
  readonly origin?: Vec3;
  /** Undefined where each row has harmonics of its own, or none. */
  readonly palette?: RowPalette;
  /** See `SplatColumns`. */
  readonly isAntialiased?: boolean;
  /** See `SplatColumns`. */
  readonly fileFacts?: FileFacts;
}

/** Values of a layout's palette; 0 without one. */
export function paletteValues({ palette }: Pick<RowLayout, 'palette'>): number {
  return palette ? palette.entryCount * palette.entryValues : 0;
}

/** Rows in as many whole chunks as fit `bytes`, at least one. */
export function rowsWithin(bytes: number, strideBytes: number): number {
  return CHUNK_SPLATS * Math.max(1, Math.floor(bytes / (strideBytes * CHUNK_SPLATS)));
}
