import type { RowLayout } from '../../data/packing/row-layout.ts';

/** Takes a file's rows as they are, in pieces; before them the values of their palette, if any. */
export interface RowSink {
  /** Whether its memory may move to another buffer while it is filled. */
  readonly mayDetach: boolean;
  /** Called first. */
  begin(layout: RowLayout): Promise<void>;
  /** Memory for the next piece, once some is free: room for `pieceRows` rows, or for all. */
  memory(): Promise<Uint8Array<ArrayBuffer>>;
  /**
   * Takes this many rows, at the beginning of that memory, which is no longer the caller's then.
   * All pieces but the last have whole chunks, and of rows that are decoded they are full. Of a
   * palette, takes this many values, in pieces of their own, of which all but the last are full.
   *
   * @param rows in the same buffer as the memory, or in the one that it has moved to.
   */
  take(rowCount: number, rows: Uint8Array<ArrayBuffer>): void;
  /** Takes what only all rows together tell, behind the notes of the layout's `fileFacts`; after the last row. */
  note?(text: string): void;
}

/** Files whose rows go to a sink, if they are of that kind; it can be posted. */
export interface RowFiles {
  /** Files with fewer rows, unless they are slow to come, or with more, are read without the sink. */
  readonly minRows: number;
  readonly maxRows: number;
  /** Bytes that are handed on at once, at most; but never less than a chunk of rows. */
  readonly pieceBytes: number;
}

/** Whether files with this many rows go to the sink. */
export function takesCount({ minRows, maxRows }: RowFiles, count: number): boolean {
  return count >= minRows && count <= maxRows;
}

/** Result of a load whose rows have gone to a sink. */
export type Passed = 'passed';

export interface RowsTo {
  readonly sink: RowSink;
  readonly files: RowFiles;
}
