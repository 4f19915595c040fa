import { CHUNK_SPLATS } from '../layout/constants.ts';
import type { FileFacts, ShDegree } from '../splats/splat-set.ts';

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
  /** See `SplatColumns`. */
  readonly isAntialiased?: boolean;
  /** See `SplatColumns`. */
  readonly fileFacts?: FileFacts;
}

/** Rows in as many whole chunks as fit `bytes`, at least one. */
export function rowsWithin(bytes: number, strideBytes: number): number {
  return CHUNK_SPLATS * Math.max(1, Math.floor(bytes / (strideBytes * CHUNK_SPLATS)));
}
